//! Runs that differ: a residual that goes if one parameter may have a value of its own in each run, a payload in one of them, say. That is
//! no effect of the machine, so it is reported with the residual and not named.

use super::image_shape::is_of_angles;
use super::torque_shape::{common, link_of};
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::check::policy::CHECK;
use crate::rigs::acrobot::gap::chained;
use crate::rigs::acrobot::selection::{Evaluation, steadiness};
use crate::rigs::acrobot::story::brief;

/// A residual that runs differ by is told so, where no clock drifts, and no law that all runs share says as much of it.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let Some(left) = so_far.filter(|_| found.drift.is_none()) else { return Judgement::Keep };
    let of_plant = link_of(&left.signal).is_some() || is_of_angles(left);
    let torques = found.torque || chained(found.signals) && of_plant;
    let study = found.study;
    let law = |at: &Evaluation| common(study, at, torques);
    let laws = Laws {
        left: law(&study.last),
        nominal: law(&study.nominal),
        squares: squares(&study.nominal.hard()),
    };
    let differ = differing(&study.last, &study.active, found.list, found.runs, &laws);
    differ.map(|shape| Unknown { shape, ..left.clone() }).into()
}

/// What laws say that all runs share.
struct Laws {
    /// Share of what is left that one takes away.
    left: f64,
    /// Share of what the nominal model leaves that one takes away.
    nominal: f64,
    /// What that leaves, in squares.
    squares: f64,
}

/// Squares that noise doesn't leave.
fn squares(hard: &Evaluation) -> f64 {
    (hard.total.square - hard.total.freedom).max(f64::MIN_POSITIVE)
}

/// In what runs differ, if in anything: the candidate of which values of their own explain most, and clearly more than a law would. An
/// effect that was named must explain more in this way than a law in its place. `active` are on, and `names` are those of the runs.
fn differing(
    at: &Evaluation,
    active: &[usize],
    list: &[Candidate],
    names: &[String],
    laws: &Laws,
) -> Option<String> {
    let machine = |index: &usize| {
        matches!(list[*index].side, Side::Plant | Side::Camera) && !list[*index].is_discrete()
    };
    let all =
        (0..list.len()).filter(machine).filter_map(|index| Some((index, steadiness(at, index, active)?)));
    let (index, runs) = all.max_by(|a, b| a.1.apart.total_cmp(&b.1.apart))?;
    if runs.runs.len() < 2 || !runs.differ() {
        return None;
    }
    let hard = at.hard();
    let left = squares(&hard) - steadiness(&hard, index, active)?.squares;
    let clear = |of: f64, law: f64| left.max(0.0) < CHECK.far_less * (1.0 - law) * of;
    let in_its_place = !active.contains(&index) || clear(laws.squares, laws.nominal);
    if !clear(squares(&hard), laws.left) || !in_its_place {
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
    use crate::rigs::acrobot::channels::Measures;
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
                drawn: Vec::new(),
            };
            Block { run, from: time, to: time + 0.5, cells: vec![cell], state: [0.0; 4] }
        });
        Evaluation::of(blocks.collect(), &[2.0], &[Perturbation { candidate: 0, by: 0.002 }], &[angle()])
    }

    fn angle() -> Signal {
        Signal {
            name: "plant.q1".into(),
            unit: "rad",
            measures: Measures::Angle,
            known: Some(0.01),
            sigma: 0.01,
            least: 0.0,
            tolerance: 0.0,
        }
    }

    /// Of so much of what is left.
    fn laws(left: f64) -> Laws {
        Laws { left, nominal: 0.0, squares: f64::INFINITY }
    }

    #[test]
    fn value_a_payload_in_one_run_is_told_with_its_run() {
        let names = ["run-01", "run-02", "run-03"].map(String::from);
        let told =
            differing(&seen([0.0, 0.0, 0.3]), &[], &[inertia()], &names, &laws(0.0)).expect("they differ");
        assert!(told.contains("plant.theta_10") && told.contains("2.30 in run-03"), "{told}");
        // the same in all is an effect, and noise is nothing
        for by in [[0.3; 3], [0.0; 3]] {
            assert_eq!(differing(&seen(by), &[], &[inertia()], &names, &laws(0.0)), None);
        }
        // a law that all runs share says nearly as much: all that an inertia of its own in each leaves is noise
        let beside = |active: &[usize], laws: &Laws| {
            differing(&seen([-0.1, -0.1, 0.2]), active, &[inertia()], &names, laws).is_some()
        };
        assert!(beside(&[], &laws(0.5)) && !beside(&[], &laws(1.0)));
        // a model that is wrong wants other values in each third of a run, too: 0.1 more or less
        let mut swaying = seen([0.0, 0.0, 0.3]);
        assert!(differing(&swaying, &[], &[inertia()], &names, &laws(0.0)).is_some());
        let sway = |block: &mut Block| {
            let wrong = if block.from % 5.0 < 2.5 { 0.1 } else { -0.1 };
            block.cells.iter_mut().for_each(|cell| {
                let column = cell.columns.column(0).into_owned();
                cell.residual.iter_mut().zip(&column).for_each(|(rest, slope)| *rest += wrong * slope);
            });
        };
        swaying.blocks.iter_mut().for_each(sway);
        let swaying =
            Evaluation::of(swaying.blocks, &[2.0], &[Perturbation { candidate: 0, by: 0.002 }], &[angle()]);
        assert_eq!(differing(&swaying, &[], &[inertia()], &names, &laws(0.0)), None);
        // the nominal model leaves as much, of which a law takes all: that the inertia is named, too, makes no runs that differ
        let whole = Laws { nominal: 1.0, squares: squares(&seen([-0.1, -0.1, 0.2]).hard()), ..laws(0.0) };
        assert!(beside(&[], &whole) && !beside(&[0], &whole));
        // seen by pictures, the same
        let mount = Candidate { side: Side::Camera, name: "camera.roll", ..inertia() };
        let told = differing(&seen([0.0, 0.3, 0.0]), &[], &[mount], &names, &laws(0.0)).expect("they differ");
        assert!(told.contains("camera.roll") && told.contains("2.30 in run-02"), "{told}");
    }
}
