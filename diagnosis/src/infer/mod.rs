//! Stochastic grey-box inference: states linked from row to row by the model, process noise by maximum likelihood.
//!
//! ```text
//! x(k+1) = F(x(k), u(k); θ) + Σᵢ Gᵢ wᵢ(k)      wᵢ ~ N(0, qᵢ² / Δt)      Gᵢ = ½ Δt (I + A) eᵢ
//! y_c(t) = h_c(x(t); θ) + ε_c                  ε_c ~ N(0, σ_c² + (σ_t dy_c/dt)²)
//! ```
//!
//! About a path x̂ both are linear in the deviations δx, δθ ([`Linearised`]). [`sweep`](fn@sweep) runs the Kalman filter
//! over a run; its innovations carry a sensitivity column for each θ, so that what is left after the states are
//! eliminated is a sum of squares, a score and a Gram matrix ([`crate::statistics::linear::Reduced`]). [`mod@smooth`] gives
//! the most likely path and process noise, [`likelihood`] the sizes of the noises, [`robust`] intervals that hold where their
//! form is wrong.
//! Kristensen, Madsen, Jørgensen, Automatica 40 (2004) 225; Bar-Shalom, Li, Kirubarajan, *Estimation*, Wiley 2001.

pub mod fit;
pub mod gradient;
pub mod likelihood;
pub mod linearised;
pub mod noise;
mod paths;
mod policy;
pub mod robust;
pub mod smooth;
pub mod sweep;

pub use fit::{At, Fit, fit};
pub use likelihood::{Sizes, maximise};
pub use linearised::{Linearised, Measured};
pub use noise::{Disturbance, Noise, first_process_noise};
pub use smooth::smooth;
