//! Defocus: N convolutions with the 3 × 3 mask of Figure 9, the border pixels replicated outwards.
//!
//! The start values of the mask are the paper's (Section 4.1.3); they sum to one. Off: N = 0.

use fmi2_export::{unit, variables};

variables! {
    /// Parameters of the defocus.
    pub struct Defocus {
        effect passes: i32 = 0, "N", "N", unit::ONE, "Defocus: number of convolutions with the mask of Figure 9.",
            min = 0, max = 64;
        parameter centre: f64 = 5.0 / 9.0, "f0", "f₀", unit::ONE, "Defocus mask (Figure 9): centre.";
        parameter edge: f64 = 2.0 / 27.0, "f1", "f₁", unit::ONE, "Defocus mask (Figure 9): the four edge neighbours.";
        parameter corner: f64 = 1.0 / 27.0, "f2", "f₂", unit::ONE,
            "Defocus mask (Figure 9): the four corner neighbours.";
    }
}
