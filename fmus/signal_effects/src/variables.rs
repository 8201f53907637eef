//! The signal unit's variables, each declared once. What they do stands in `lib.rs`.

use fmi2_export::{table, unit, variables};

variables! {
    /// What comes in.
    pub struct Inputs {
        input value: f64 = 0.0, "u", "u", unit::ANY,
            "The value that comes in. Over a step it is what was set before it (see linear).";
        input disturbance: f64 = 0.0, "d", "d", unit::ANY,
            "Added to what goes out, past all effects: the course of an unknown input, for instance.";
    }
}

variables! {
    /// What goes out.
    pub struct Outputs {
        output value: f64 = 0.0, "y", "y", unit::ANY,
            "The value that goes out: u after delay, saturation, rate limit, lag, gain, bias, drift, and d.";
    }
}

variables! {
    /// The effects, in the order in which a value passes them: that of the plant's actuator.
    pub struct Effects {
        fixed_effect delay: f64 = 0.0, "delay", "T_d", unit::SECOND,
            "Dead time; u at the start holds before. Off at 0.", min = 0.0;
        effect saturation: f64 = 0.0, "saturation", "L", unit::ANY,
            "Largest magnitude either way; off (no limit) at 0.", min = 0.0;
        effect rate_limit: f64 = 0.0, "rate_limit", "R", unit::ANY,
            "Largest rate of change per second; off (no limit) at 0.", min = 0.0;
        effect lag: f64 = 0.0, "lag", "T", unit::SECOND,
            "Time constant of a first-order lag; off at 0.", min = 0.0;
        effect gain: f64 = 1.0, "gain", "k", unit::ONE,
            "Factor; off at 1.";
        effect bias: f64 = 0.0, "bias", "b", unit::ANY,
            "Added; behind an output: its offset. Off at 0.";
        effect drift: f64 = 0.0, "drift", "r", unit::ANY,
            "Added per second since the start; off at 0.";
    }
}

variables! {
    /// How values between communication points are meant.
    pub struct Hold {
        parameter linear: bool = false, "linear", "", unit::ONE,
            "false: what is set before a step holds over it; true: it is the value at the step's end, and a line \
             leads there from the value before.";
    }
}

table! {
    /// All variables of the signal unit.
    pub struct Variables {
        /// Inputs.
        pub inputs: Inputs,
        /// Outputs.
        pub outputs: Outputs,
        /// Effects.
        pub effects: Effects,
        /// Hold.
        pub hold: Hold,
    }
}
