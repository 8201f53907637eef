//! What depends on what: ModelStructure and directional derivatives.
//!
//! The derivatives of (q̇, q̈) by (q, q̇, tau, tau_1, tau_2) are the linearised plant with all its effects, at any state.
//! Those by states are fourth-order central differences of the equation of motion, within 1e-9 of the derivative, and beside them Coulomb
//! friction's own derivative, whose smoothing may be far narrower than a difference; those by torques are exact.

use crate::{Plant, Variables, dynamics::Dynamics, effects::Motion};
use fmi2_export::Dependencies;
use mechanics::Equation;

const STATES: [&str; 4] = ["q1", "q2", "dq1", "dq2"];
/// Steps of the differences, rad and rad/s.
const DIFFERENCES: [f64; 4] = [1e-4, 1e-4, 2e-5, 2e-5];

/// ModelStructure.
pub fn dependencies(output: &str) -> Dependencies {
    const NOTHING: &[&str] = &[];
    let (while_stepping, at_start): (&'static [&'static str], Option<&'static [&'static str]>) = match output
    {
        "q1" => (NOTHING, Some(&["q1_0"])),
        "q2" => (NOTHING, Some(&["q2_0"])),
        "dq1" => (NOTHING, Some(&["dq1_0", "q2_0", "q2_max"])),
        "dq2" => (NOTHING, Some(&["dq2_0", "q2_0", "q2_max"])),
        "contact" => (NOTHING, Some(&["q2_0", "q2_max"])),
        "z" => (
            NOTHING,
            Some(&["q2_0", "theta_1", "theta_2", "theta_5", "theta_7", "theta_8", "theta_9", "theta_10"]),
        ),
        "tau_applied" => (
            &["tau"],
            Some(&["tau", "tau_0", "tau_max", "dtau_max", "T_act", "tau_delay", "k_tau", "tau_bias"]),
        ),
        _ => (&["tau", "tau_1", "tau_2", "q1", "q2", "dq1", "dq2"], None),
    };
    Dependencies { while_stepping, at_start }
}

/// ∂unknown/∂known at the current communication point, with the torque that the actuator gives there.
pub fn derivative(plant: &Plant, variables: &Variables, unknown: &str, known: &str) -> Option<f64> {
    let state = STATES.iter().position(|name| *name == known);
    if state.is_none() && !matches!(known, "tau" | "tau_1" | "tau_2") {
        return None;
    }
    if let Some(place) = STATES.iter().position(|name| *name == unknown) {
        return Some(if state == Some(place) { 1.0 } else { 0.0 });
    }
    match unknown {
        "ddq1" => Some(by_acceleration(plant, variables, known, state)[0]),
        "ddq2" => Some(by_acceleration(plant, variables, known, state)[1]),
        "tau_applied" => Some(if known == "tau" { feedthrough(plant, variables) } else { 0.0 }),
        "z" if known == "q2" => Some(plant.places.current().map_or(0.0, |place| place.slope(plant.state[1]))),
        "z" => Some(0.0),
        _ => None,
    }
}

/// ∂q̈/∂known.
fn by_acceleration(plant: &Plant, variables: &Variables, known: &str, state: Option<usize>) -> [f64; 2] {
    if plant.contact {
        return [0.0; 2];
    }
    let q = [plant.state[0], plant.state[1]];
    let by_force = |f1: f64, f2: f64| {
        let motion = Motion { q, dq: [0.0; 2] };
        let mass = Dynamics::new(variables, [0.0; 2]).equation(&motion, 0.0, 0.0);
        Equation { f1, f2, ..mass }.accelerations()
    };
    match (state, known) {
        (Some(place @ (0 | 1)), _) => by_differences(variables, plant.state, place),
        (Some(place), _) => {
            let mut smooth = variables.clone();
            (smooth.effects.coulomb.roll, smooth.effects.coulomb.joint) = (0.0, 0.0);
            let rest = by_differences(&smooth, plant.state, place);
            let motion = Motion { q, dq: [plant.state[2], plant.state[3]] };
            let [roll, joint] = variables.effects.coulomb.slopes(&motion);
            // the rate of the joint is dq2 - dq1, and its torque acts on link 2 and back on link 1
            let own = if place == 2 { by_force(roll + joint, -joint) } else { by_force(-joint, joint) };
            [rest[0] + own[0], rest[1] + own[1]]
        }
        (None, "tau") => {
            let by = feedthrough(plant, variables);
            by_force(-by, by)
        }
        (None, "tau_1") => by_force(1.0, 0.0),
        (None, _) => by_force(0.0, 1.0),
    }
}

/// ∂q̈/∂ a place of the state.
fn by_differences(variables: &Variables, state: [f64; 4], place: usize) -> [f64; 2] {
    let dynamics = Dynamics::new(variables, [0.0; 2]);
    let step = DIFFERENCES[place];
    let at = |multiple: f64| {
        let mut moved = state;
        moved[place] += multiple * step;
        let motion = Motion { q: [moved[0], moved[1]], dq: [moved[2], moved[3]] };
        dynamics.equation(&motion, variables.outputs.applied_torque, 0.0).accelerations()
    };
    let [far_before, before, after, far_after] = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
    [0, 1].map(|i| (8.0 * (after[i] - before[i]) - (far_after[i] - far_before[i])) / (12.0 * step))
}

/// ∂tau_applied/∂tau: 0 where the actuator needs time, or is saturated. What is on its way in a delay doesn't matter to that.
fn feedthrough(plant: &Plant, variables: &Variables) -> f64 {
    variables.effects.feedthrough(&plant.actuator, 0.0, variables.inputs.torque)
}
