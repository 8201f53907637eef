//! The FMI variables of the camera, put together from the rooms that own them.

use crate::effects::Effects;
use fmi2_export::{table, unit, variables};

variables! {
    /// The pose of the robot.
    pub struct Inputs {
        input link1_angle: f64 = 0.0, "q1", "q₁", unit::RADIAN,
            "Angle of link 1 from the upright, positive towards +u.";
        input link2_angle: f64 = 0.0, "q2", "q₂", unit::RADIAN,
            "Angle of link 2 from the upright, positive towards +u.";
        input link1_rate: f64 = 0.0, "dq1", "q̇₁", unit::RADIAN_PER_SECOND,
            "Rate of q1; serves only to interpolate the pose between communication points.",
            derivative_of = "q1";
        input link2_rate: f64 = 0.0, "dq2", "q̇₂", unit::RADIAN_PER_SECOND,
            "Rate of q2; serves only to interpolate the pose between communication points.",
            derivative_of = "q2";
    }
}

variables! {
    /// What the vision system says.
    pub struct Outputs {
        output link1_angle: f64 = 0.0, "q1_est", "q̂₁", unit::RADIAN,
            "Estimate of q1 from the newest valid frame.";
        output link2_angle: f64 = 0.0, "q2_est", "q̂₂", unit::RADIAN,
            "Estimate of q2 from the newest valid frame.";
        output link1_rate: f64 = 0.0, "dq1_est", "dq̂₁", unit::RADIAN_PER_SECOND,
            "First-order difference of the two newest valid estimates of q1, 0 at the first (Section 3.2).";
        output link2_rate: f64 = 0.0, "dq2_est", "dq̂₂", unit::RADIAN_PER_SECOND,
            "First-order difference of the two newest valid estimates of q2, 0 at the first (Section 3.2).";
        output u1_px: f64 = 0.0, "u1", "u₁", unit::PIXEL, "Centroid of circle 1 (drum), right of the image centre.";
        output v1_px: f64 = 0.0, "v1", "v₁", unit::PIXEL, "Centroid of circle 1 (drum), above the image centre.";
        output u2_px: f64 = 0.0, "u2", "u₂", unit::PIXEL, "Centroid of circle 2 (joint), right of the image centre.";
        output v2_px: f64 = 0.0, "v2", "v₂", unit::PIXEL, "Centroid of circle 2 (joint), above the image centre.";
        output u3_px: f64 = 0.0, "u3", "u₃", unit::PIXEL, "Centroid of circle 3 (tip), right of the image centre.";
        output v3_px: f64 = 0.0, "v3", "v₃", unit::PIXEL, "Centroid of circle 3 (tip), above the image centre.";
        output area1: f64 = 0.0, "area1", "N₁", unit::PIXEL, "Pixels of circle 1 at or above the threshold.";
        output area2: f64 = 0.0, "area2", "N₂", unit::PIXEL, "Pixels of circle 2 at or above the threshold.";
        output area3: f64 = 0.0, "area3", "N₃", unit::PIXEL, "Pixels of circle 3 at or above the threshold.";
        output valid: bool = false, "valid", "valid", unit::ONE,
            "All three circles were found and matched in the newest delivered frame; otherwise the last estimate is held.";
        output frame: i32 = 0, "frame", "n", unit::ONE, "Number of delivered frames; 0: none yet.";
        output mid_exposure: f64 = 0.0, "t_mid", "t_mid", unit::SECOND,
            "Time of mid-exposure of the newest delivered frame.";
        output frame_index: i32 = -1, "frame_index", "k", unit::ONE,
            "Number k of the newest delivered frame, whose exposure ended at k/omega_cam; -1: none yet.";
    }
}

variables! {
    /// What stands before the camera (Section 4).
    pub struct Scene {
        fixed drum_radius: f64 = 1.0, "R", "R", unit::WORLD_UNIT,
            "Radius of the drum that rolls on the ground; circle 1 sits at its centre.", min = 0.0;
        fixed link1_length: f64 = 6.19, "l1", "l₁", unit::WORLD_UNIT,
            "Distance from the drum's centre to the joint (Section 4).", min = 1e-6;
        fixed link2_length: f64 = 6.9, "l2", "l₂", unit::WORLD_UNIT,
            "Distance from the joint to the tip (Section 4).", min = 1e-6;
        fixed circle_radius: f64 = 0.2, "radius", "r", unit::WORLD_UNIT,
            "Radius of the inscribed circles (Section 4).", min = 1e-6;
        fixed ground_height: f64 = -8.0, "ground", "y_g", unit::WORLD_UNIT,
            "World y of the ground line; the paper's Table 3 fixes it.";
        fixed field_of_view: f64 = 20.0, "field_of_view", "FOV", unit::WORLD_UNIT,
            "Width of the scene seen by the camera (Section 4).", min = 1e-6;
        parameter foreground: f64 = 255.0, "foreground", "I_fg", unit::GREY_LEVEL,
            "Grey level of the circles.", min = 0.0, max = 255.0;
        parameter background: f64 = 0.0, "background", "I_bg", unit::GREY_LEVEL,
            "Grey level of everything else.", min = 0.0, max = 255.0;
    }
}

variables! {
    /// The camera itself and its vision system (Sections 2.3, 3.2, 4).
    pub struct Sensor {
        fixed width: i32 = 512, "width", "N_x", unit::PIXEL, "Columns of a frame (Section 4).", min = 16, max = 8192;
        fixed height: i32 = 512, "height", "N_y", unit::PIXEL, "Rows of a frame (Section 4).", min = 16, max = 8192;
        fixed focal_length: f64 = 2.0, "f", "f", unit::IMAGE_UNIT,
            "Focal length (1), (2); the scene's plane lies at f · field_of_view / 2. Not given in the paper.",
            min = 1e-3;
        fixed frame_rate: f64 = 30.0, "omega_cam", "ω_cam", unit::HERTZ,
            "Frames per second (Section 2.3); fields come at twice this rate if interlaced.", min = 1e-6, max = 1e6;
        fixed exposure_factor: f64 = 0.01, "E_t", "E_t", unit::ONE,
            "Share of the sample period during which the shutter is open (Section 2.2; 0.01 in Section 4).",
            min = 0.0, max = 1.0;
        parameter delay: f64 = 0.0, "T_delay", "T_delay", unit::SECOND,
            "T_out + T_calc: from the end of the exposure to the delivery of the result (Section 2.3).", min = 0.0;
        fixed interlaced: bool = false, "interlaced", "interlaced", unit::ONE,
            "Fields of half the rows, alternately even and odd ones, at twice omega_cam (Section 2.3).";
        parameter threshold: f64 = 191.0, "threshold", "c", unit::GREY_LEVEL,
            "Pixels at or above this level are feature pixels (Section 3.2); at 191 a circle covers 75 px.",
            min = 1.0, max = 255.0;
        parameter smallest_area: i32 = 40, "N_min", "N_min", unit::PIXEL,
            "Smallest area of a region that may be a circle (Section 3.2).", min = 1;
        parameter largest_area: i32 = 130, "N_max", "N_max", unit::PIXEL,
            "Largest area of a region that may be a circle (Section 3.2).", min = 1;
        fixed mount: f64 = 0.0, "mount", "ρ_0", unit::RADIAN,
            "Roll of the mounting that the vision reckons with; what roll differs by is an error of the mounting.",
            min = -3.2, max = 3.2;
        fixed seed: i32 = 0, "seed", "seed", unit::ONE,
            "Chooses the noise and which frames are lost; same seed, same frames.";
        fixed frames_dir: String = String::new(), "frames_dir", "frames_dir", unit::ONE,
            "Folder into which frames are written as frame_000042.png (created if missing); empty: none.";
        fixed frames_every: i32 = 1, "frames_every", "frames_every", unit::ONE,
            "Only every n-th frame is written.", min = 1;
        fixed estimator: i32 = 0, "estimator", "estimator", unit::ONE,
            "How a circle's centre is found: 0 = centroid of the binary image (the paper's), 1 = centroid of the grey \
             levels around it, 2 = maximum likelihood.", min = 0, max = 2;
    }
}

impl Sensor {
    /// A direction or a place about the middle of the picture as a camera shows it that is mounted upright.
    pub fn upright(&self, (u, v): (f64, f64)) -> (f64, f64) {
        if self.mount == 0.0 {
            return (u, v);
        }
        let (sin, cos) = (libm::sin(self.mount), libm::cos(self.mount));
        (u * cos + v * sin, v * cos - u * sin)
    }
}

table! {
    /// All variables of the unit.
    pub struct Variables {
        /// The pose of the robot.
        pub inputs: Inputs,
        /// What the vision system says.
        pub outputs: Outputs,
        /// What stands before the camera.
        pub scene: Scene,
        /// The camera itself and its vision system.
        pub sensor: Sensor,
        /// Lens and sensor effects in the order of the light path.
        pub effects: Effects,
    }
}
