//! Lost frames: a share of the frames is never delivered.
//!
//! Whether frame k is lost depends on (seed, k) alone. *Deviations*: beyond the paper, for the diagnosis. Off: 0.

use crate::photometry::noise::mixed;
use fmi2_export::{unit, variables};

variables! {
    /// Parameter of the frame loss.
    pub struct Loss {
        effect share: f64 = 0.0, "drop_rate", "drop_rate", unit::ONE,
            "Share of the frames that are lost: not seen by the vision system, not counted.", min = 0.0, max = 1.0;
    }
}

/// Keeps these draws apart from the noise keys of the same (seed, frame).
const STREAM: u64 = 0x6c6f_7373;

impl Loss {
    /// Whether frame `k` is lost.
    pub fn takes(&self, seed: i32, k: i64) -> bool {
        let draw = (mixed(seed, k, STREAM) >> 11) as f64 / (1u64 << 53) as f64;
        draw < self.share
    }
}
