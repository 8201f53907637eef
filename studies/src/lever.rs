//! First-order theory of the steady error: what a constant estimation error does to the place.
//!
//! To first order, whatever the scheduling, a constant estimation error e = q − q̂ moves the acrobot by
//!
//! ```text
//! z − z_d = e₀ + (a₂/a₀)·e₂ + e₄/a₀,      e₀ = c·p·e,  e₂ = c·pK·e,  e₄ = c·pK²·e
//! ```
//!
//! with the plant's stiffness K, the row p of the pseudolinearizing coordinate, its scale c, and the closed loop's
//! polynomial s⁴ + a₃s³ + a₂s² + a₁s + a₀.

use crate::Error;
use crate::closed_loop::Poles;
use crate::lens::Lens;
use crate::walk::Look;
use mechanics::{MechanicsError, Place, Theta};

/// e₀, e₂, e₄ of a lens at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lever(pub(crate) [f64; 3]);

fn mechanics(error: MechanicsError) -> Error {
    Error::Mechanics(error.to_string())
}

impl Lever {
    /// Of an estimation error at q₂.
    fn of(place: &Place, q2: f64, error: [f64; 2]) -> Result<Lever, Error> {
        let plant = Theta::TABLE_2.linearisation(q2).map_err(mechanics)?;
        let p = plant.p().map_err(mechanics)?;
        let pk = plant.times_stiffness(p);
        let rows = [p, pk, plant.times_stiffness(pk)];
        Ok(Lever(rows.map(|row| place.scale() * (row[0] * error[0] + row[1] * error[1]))))
    }

    /// Of the estimation error in frames at `z`, averaged over ±0.05 rad of q₂ against the lattice of pixels.
    pub(crate) fn new(looks: &[Look], z: f64) -> Result<Lever, Error> {
        let place = Place::new(&Theta::TABLE_2).map_err(mechanics)?;
        let q2 = place.q2(z);
        let near: Vec<[f64; 2]> = (looks.iter())
            .filter(|look| look.valid && (look.pose[1] - q2).abs() <= 0.05)
            .map(Look::error)
            .collect();
        let mean = [0, 1].map(|i| near.iter().map(|error| error[i]).sum::<f64>() / near.len() as f64);
        Lever::of(&place, q2, mean)
    }

    /// z_desired − z by first-order theory.
    pub(crate) fn steady_error(&self, poles: &Poles) -> f64 {
        let [a0, _, a2, _] = poles.polynomial();
        let Lever([e0, e2, e4]) = self;
        -(e0 + a2 / a0 * e2 + e4 / a0)
    }
}

/// z_desired − z where the loop rests behind a lens, by the equations of the lens and first-order theory alone: no
/// unit has a part in it. The lens is read where the robot rests, not where it was asked to be.
pub(crate) fn rest(lens: Lens, poles: &Poles, z_desired: f64) -> Result<f64, Error> {
    let place = Place::new(&Theta::TABLE_2).map_err(mechanics)?;
    let mut z = z_desired;
    // Errors change by less than themselves over a unit of z, so that half steps come to rest.
    for _ in 0..40 {
        let q2 = place.q2(z);
        let there = Lever::of(&place, q2, lens.error(q2))?;
        z = 0.5 * (z + z_desired - there.steady_error(poles));
    }
    Ok(z_desired - z)
}
