//! Parameters of our units that a diagnosis asks for and never frees, each under one name.

/// Angle between the links at which they touch, rad.
pub const LIMIT: &str = "plant.q2_max";
/// How far the camera is turned about its axis as its vision knows, rad.
pub const MOUNT: &str = "camera.mount";
/// Frames a second.
pub const FRAME_RATE: &str = "camera.omega_cam";
/// Its frames are fields of half the rows.
pub const INTERLACED: &str = "camera.interlaced";
/// Width of the image, px.
pub const WIDTH: &str = "camera.width";
/// Height of the image, px.
pub const HEIGHT: &str = "camera.height";
/// Width that it shows, world units.
pub const FIELD_OF_VIEW: &str = "camera.field_of_view";
/// Height of the ground in it, world units.
pub const GROUND: &str = "camera.ground";
/// Lengths of the links that it shows, world units, and those of the paper's arm.
pub const LINKS: [(&str, f64); 2] = [("camera.l1", 6.19), ("camera.l2", 6.9)];
/// Radius of the drum that it shows, world units.
pub const DRUM: &str = "camera.R";
