//! Runs that differ: a residual that goes if one parameter may have a value of its own in each run, a payload in one of them, say. That is
//! no effect of the machine, so it is reported with the residual and not named.

use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::{Evaluation, steadiness};
use crate::rigs::acrobot::story::brief;

/// A residual that runs differ by is told so, where no clock drifts.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let Some(left) = so_far.filter(|_| found.torque && found.drift.is_none()) else { return Judgement::Keep };
    let differ = differing(&found.study.last, &found.study.active, found.list, found.runs);
    differ.map(|shape| Unknown { shape, ..left.clone() }).into()
}

/// In what runs differ, if in anything: the candidate of the plant of which values of their own explain most. `active` are on, and `names`
/// those of the runs.
fn differing(at: &Evaluation, active: &[usize], list: &[Candidate], names: &[String]) -> Option<String> {
    let plants = |index: &usize| list[*index].side == Side::Plant && !list[*index].is_discrete();
    let all =
        (0..list.len()).filter(plants).filter_map(|index| Some((index, steadiness(at, index, active)?)));
    let (index, runs) = all.max_by(|a, b| a.1.apart.total_cmp(&b.1.apart))?;
    if runs.runs.len() < 2 || runs.apart < POLICY.runs_apart {
        return None;
    }
    let own = &list[index];
    let each = runs.runs.iter().filter_map(|(run, (by, _))| {
        let value = own.value((at.point[index] + by).clamp(own.range.0, own.range.1));
        Some(format!("{} in {}", brief(value), names.get(*run)?))
    });
    let each: Vec<String> = each.collect();
    Some(format!("runs that differ: {} ({}) would be {}", own.name, own.phrase, each.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::Motion;
    use crate::rigs::acrobot::residual::{Block, Perturbation, Signal};
    use crate::statistics::linear::Cell;
    use crate::statistics::random::Random;
    use nalgebra::DMatrix;

    fn inertia() -> Candidate {
        let motion = Motion::Share { steps: &[0.001], range: (0.25, 4.0) };
        let (name, side, phrase) = ("plant.theta_10", Side::Plant, "gravity torque of the second link");
        Candidate {
            name,
            side,
            phrase,
            motion,
            off: 2.0,
            steps: vec![0.002],
            range: (0.5, 8.0),
            nonlinear: false,
            attributes: &[],
        }
    }

    /// Ten blocks of each of three runs, in which the inertia is larger by so much.
    fn seen(by: [f64; 3]) -> Evaluation {
        let mut random = Random::new(3);
        let blocks = (0..30).map(|place| {
            let (run, time) = (place / 10, f64::from(place as u32 % 10));
            let column = DMatrix::from_fn(12, 1, |_, _| random.normal());
            let residual = column.iter().map(|slope| by[run] * slope + 0.01 * random.normal()).collect();
            let cell = Cell {
                residual,
                sigma: vec![0.01; 12],
                signal: vec![0; 12],
                time: vec![time; 12],
                hard: DMatrix::zeros(12, 0),
                soft: DMatrix::zeros(12, 0),
                discrepancy: 0,
                inertia_scale: 1.0,
                columns: column,
                floor: Vec::new(),
                state: vec![0.0; 4],
                lattice: Vec::new(),
            };
            Block { run, from: time, to: time + 0.5, cells: vec![cell], state: [0.0; 4] }
        });
        let signal = Signal {
            name: "plant.q1".into(),
            unit: "rad",
            known: Some(0.01),
            sigma: 0.01,
            least: 0.0,
            tolerance: 0.0,
        };
        Evaluation::of(blocks.collect(), &[2.0], &[Perturbation { candidate: 0, by: 0.002 }], &[signal])
    }

    #[test]
    fn value_a_payload_in_one_run_is_told_with_its_run() {
        let names = ["run-01", "run-02", "run-03"].map(String::from);
        let told = differing(&seen([0.0, 0.0, 0.3]), &[], &[inertia()], &names).expect("they differ");
        assert!(told.contains("plant.theta_10") && told.contains("2.30 in run-03"), "{told}");
        // the same in all is an effect, and noise is nothing
        for by in [[0.3; 3], [0.0; 3]] {
            assert_eq!(differing(&seen(by), &[], &[inertia()], &names), None);
        }
    }
}
