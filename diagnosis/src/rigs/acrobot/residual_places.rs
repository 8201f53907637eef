//! Where simulation and data disagree: in which signals, when, in which states; and the residual over time for the report.

use crate::diagnosis::{Trace, Where};
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::check::link_of;
use crate::rigs::acrobot::gap::measures;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::{ANGLES, AREAS, COLUMNS};
use crate::rigs::acrobot::residual::torque::torques;
use crate::rigs::acrobot::selection::{Evaluation, Study};
use crate::statistics::levels::{DOUBTED, MORE};
use crate::statistics::linear::bare;
use crate::statistics::median::median;

/// By how much one signal disagrees, and where.
pub struct Place {
    /// Squares beyond what noise leaves; below 0 within it.
    excess: f64,
    /// Some block has more of them than chance gives.
    sure: bool,
    place: Where,
}

impl Place {
    /// Whether it disagrees by more than noise.
    pub fn disagrees(&self) -> bool {
        self.sure && self.excess > 0.0
    }

    /// The name of its signal.
    pub fn signal(&self) -> &str {
        &self.place.signal
    }

    /// Squares beyond what noise leaves.
    pub fn excess(&self) -> f64 {
        self.excess
    }
}

/// The blocks of one signal.
#[derive(Default)]
struct Course {
    /// Squares beyond what noise leaves of each block, with its state and its times.
    blocks: Vec<(f64, [f64; 4], [f64; 2])>,
    /// Those that have more of them than chance gives.
    sure: Vec<[f64; 2]>,
}

/// What each measured signal disagrees by under the nominal model, when, and in which states. `blamed` is that of what has no name.
pub fn places(study: &Study, signals: &[Signal], blamed: Option<&str>) -> Vec<Place> {
    let noise = noise((&study.noise, &study.last.sigmas), signals, blamed);
    let nominal = study.nominal.with(&noise);
    let level = blamed.map_or(0.0, |_| area_level(&nominal, signals));
    places_of(&nominal, signals, level)
}

/// The same of residuals under the noise by which they are judged, with this level of areas, px.
fn places_of(nominal: &Evaluation, signals: &[Signal], level: f64) -> Vec<Place> {
    let mut courses: Vec<Course> = signals.iter().map(|_| Course::default()).collect();
    for block in &nominal.blocks {
        let mut own = vec![0.0; signals.len()];
        let mut rows = vec![0.0; signals.len()];
        for cell in &block.cells {
            let level = |signal: &usize| if AREAS.contains(signal) { level } else { 0.0 };
            let rows_left = cell.residual.iter().zip(&cell.signal).map(|(left, signal)| left - level(signal));
            let residual = bare(cell, &rows_left.collect::<Vec<_>>(), 0.0).residual;
            for row in 0..cell.residual.len() {
                own[cell.signal[row]] += residual[row] * residual[row];
                rows[cell.signal[row]] += 1.0;
            }
        }
        for (course, (own, rows)) in courses.iter_mut().zip(own.iter().zip(&rows)).filter(|(_, s)| *s.1 > 0.0)
        {
            let (over, times) = (own - rows, [block.from, block.to]);
            course.blocks.push((over, block.state, times));
            // so many standard deviations of a sum of squares
            course.sure.extend((over > DOUBTED * (2.0 * rows).sqrt()).then_some(times));
        }
    }
    let measured = signals.iter().zip(courses).filter(|(_, course)| !course.blocks.is_empty());
    measured.map(|(signal, course)| course.place(&signal.name)).collect()
}

/// What areas of an image differ by alike, px: as far as right renderers may, it is no disagreement. The middle of all is that of the circles that
/// are right, where the mean, which is off already, is moved by one that isn't.
fn area_level(nominal: &Evaluation, signals: &[Signal]) -> f64 {
    let pictured = signals.get(AREAS.start).is_some_and(|signal| signal.measures == Measures::Area);
    let cells = nominal.blocks.iter().flat_map(|block| &block.cells).filter(|_| pictured);
    let rows = cells.flat_map(|cell| cell.signal.iter().zip(&cell.residual));
    let areas = rows.filter(|(signal, _)| AREAS.contains(signal)).map(|(_, left)| *left);
    median(areas).filter(|level| level.abs() < IMAGES.level).unwrap_or(0.0)
}

impl Course {
    fn place(mut self, signal: &str) -> Place {
        let sure = !self.sure.is_empty();
        let all = self.blocks.iter().map(|(.., times)| *times).collect();
        let spans = if sure { self.sure } else { all };
        let place = Where {
            signal: signal.to_owned(),
            share: 0.0,
            from: spans.iter().map(|times| times[0]).fold(f64::INFINITY, f64::min),
            to: spans.iter().map(|times| times[1]).fold(f64::NEG_INFINITY, f64::max),
            region: region(&mut self.blocks),
        };
        Place { excess: self.blocks.iter().map(|(over, ..)| over).sum(), sure, place }
    }
}

/// The noise that each signal is judged by, from what sensors give it and that in use. Where something has no name, the latter covers that as well, so
/// that its own signal would disagree least: what sensors give counts where it is far less, and for the signal that is `blamed`.
fn noise((own, used): (&[f64], &[f64]), signals: &[Signal], blamed: Option<&str>) -> Vec<f64> {
    let Some(blamed) = blamed else { return used.to_vec() };
    let of = |(signal, (own, used)): (&Signal, (&f64, &f64))| {
        let covers = *used > MORE * own || signal.name == blamed;
        if covers && *own > 0.0 { own.min(*used) } else { *used }
    };
    signals.iter().zip(own.iter().zip(used)).map(of).collect()
}

/// Turns excesses into shares and drops crumbs; the signal of what has no name stays, whatever its share.
pub fn shares(found: Vec<Place>, blamed: Option<&str>) -> Vec<Where> {
    let is_blamed = |place: &Place| blamed == Some(place.signal());
    let others: f64 = found.iter().filter(|place| place.disagrees()).map(|place| place.excess).sum();
    let told = found.into_iter().filter(|place| place.disagrees() || is_blamed(place));
    let least =
        |place: &Place| if is_blamed(place) { (POLICY.listed * others).max(f64::MIN_POSITIVE) } else { 0.0 };
    let told: Vec<Place> =
        told.map(|place| Place { excess: place.excess.max(least(&place)), ..place }).collect();
    let total: f64 = told.iter().map(|place| place.excess).sum();
    let kept = told.into_iter().filter(|place| place.excess >= POLICY.listed * total || is_blamed(place));
    let mut all: Vec<Where> =
        kept.map(|Place { excess, place, .. }| Where { share: excess / total, ..place }).collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}

/// The states of the tenth of the blocks that disagree most.
fn region(worst: &mut [(f64, [f64; 4], [f64; 2])]) -> String {
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let many = worst.len().div_ceil(10);
    let of = |index: usize, slice: &[(f64, [f64; 4], [f64; 2])]| {
        let values = slice.iter().map(|(_, state, _)| state[index]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((a, b), (c, d)) = (of(1, &worst[..many]), of(1, worst));
    let ((e, f), (g, h)) = (of(3, &worst[..many]), of(3, worst));
    format!(
        "most where q2 is {a:.2} to {b:.2} rad (of {c:.2} to {d:.2}) and dq2 {e:.2} to {f:.2} rad/s (of {g:.2} to {h:.2})"
    )
}

/// Which signal of an image is shown, if it was measured: the tip goes furthest.
const SHOWN: [usize; 8] = [4, 5, 2, 3, 10, 9, 0, 1];

/// Residuals over time for the report, of the signal that is blamed: torque on a link, or a coordinate in the image.
pub fn trace(study: &Study, torque: bool, blamed: &str) -> Trace {
    let measured = |signal: &usize| measures(&study.last.blocks, &(*signal..*signal + 1));
    let named = COLUMNS.iter().position(|name| blamed.ends_with(&format!(".{name}"))).filter(measured);
    let shown = named.or_else(|| SHOWN.into_iter().find(measured)).unwrap_or(SHOWN[0]);
    let link = link_of(blamed).unwrap_or(1);
    let of = |evaluation: &Evaluation| -> Vec<(f64, f64)> {
        let mut base = 0.0;
        let mut run = usize::MAX;
        let (mut begin, mut end) = (0.0, 0.0);
        let lacking =
            if torque { torques(&evaluation.blocks, &[], &[], &study.folds.of) } else { Vec::new() };
        let mut points = Vec::new();
        for (index, block) in evaluation.blocks.iter().enumerate() {
            if block.run != run {
                base += end - begin;
                (run, begin) = (block.run, block.from);
            }
            end = block.to + 1.0;
            if torque {
                let own: Vec<f64> =
                    lacking.iter().filter(|t| t.block == index).map(|t| t.torque[link]).collect();
                let middle = base - begin + 0.5 * (block.from + block.to);
                points.push((middle, own.iter().sum::<f64>() / own.len().max(1) as f64));
            } else {
                for cell in &block.cells {
                    if let Some(row) = cell.signal.iter().position(|s| *s == shown) {
                        points.push((base - begin + cell.time[row], cell.residual[row]));
                    }
                }
            }
        }
        points
    };
    Trace {
        title: match torque {
            true => format!("Torque that the model lacks {}", ["on link 1", "at the joint"][link]),
            false => format!("In the image, {}: measured - rendered", COLUMNS[shown]),
        },
        unit: match torque {
            true => "N·m",
            false if ANGLES.contains(&shown) => "rad",
            false => "px",
        }
        .into(),
        link,
        before: of(&study.nominal),
        after: of(&study.last),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::Block;
    use crate::statistics::linear::Cell;
    use nalgebra::DMatrix;

    const NOISE: f64 = 0.05;
    /// What has no name shows in no signal that is measured.
    const ELSEWHERE: Option<&str> = Some("timestamps of the image");

    /// What is told of the camera's signals in a hundred blocks of 40 frames, which are off by so much, where sensors give 0.05 each.
    fn told(off: &dyn Fn(usize) -> f64, blamed: Option<&str>) -> Vec<Where> {
        let (frames, count) = (40, AREAS.end);
        let block = |index: u32| {
            let cell = Cell {
                residual: (0..frames * count).map(|row| off(row % count)).collect(),
                sigma: vec![1.0; frames * count],
                signal: (0..frames * count).map(|row| row % count).collect(),
                time: vec![f64::from(index); frames * count],
                hard: DMatrix::zeros(frames * count, 0),
                soft: DMatrix::zeros(frames * count, 0),
                discrepancy: 0,
                inertia_scale: 1.0,
                columns: DMatrix::zeros(frames * count, 0),
                floor: Vec::new(),
                state: Vec::new(),
                lattice: Vec::new(),
                drawn: Vec::new(),
            };
            let (from, to) = (f64::from(index), f64::from(index + 1));
            Block { run: 0, from, to, cells: vec![cell], state: [0.0; 4] }
        };
        let signals: Vec<Signal> = (0..count).map(signal).collect();
        let at = Evaluation::of((0..100).map(block).collect(), &[], &[], &signals);
        let noise = noise((&[NOISE; AREAS.end], &at.sigmas), &signals, blamed);
        let level = area_level(&at, &signals);
        shares(places_of(&at.with(&noise), &signals, level), blamed)
    }

    fn signal(place: usize) -> Signal {
        Signal {
            name: format!("camera.{}", COLUMNS[place]),
            unit: "px",
            measures: if AREAS.contains(&place) { Measures::Area } else { Measures::Centroid },
            known: None,
            sigma: 1.0,
            least: 0.0,
            tolerance: 0.0,
        }
    }

    /// The same where one centroid is off by so much, and all else by noise.
    fn one_off(by: f64, blamed: Option<&str>) -> Vec<Where> {
        told(&|signal| if signal == 0 { by } else { NOISE }, blamed)
    }

    #[test]
    fn law_a_signal_is_judged_by_what_sensors_give_where_the_noise_in_use_covers_what_it_is_off_by() {
        let all = one_off(0.4, ELSEWHERE);
        assert!(all.len() == 1 && all[0].signal == "camera.u1", "{all:?}");
        assert!(all[0].share > 0.99 && (all[0].from, all[0].to) == (0.0, 100.0), "{all:?}");
        // what is a little more than sensors give is taken for noise, and so is what a model leaves that lacks nothing
        assert!(one_off(0.06, ELSEWHERE).is_empty() && one_off(0.4, None).is_empty());
    }

    #[test]
    fn law_the_signal_of_what_has_no_name_is_always_told() {
        let signals = |told: Vec<Where>| told.into_iter().map(|place| place.signal).collect::<Vec<_>>();
        assert_eq!(signals(one_off(0.06, Some("camera.u1"))), ["camera.u1"]);
        assert_eq!(signals(one_off(0.4, Some("camera.u2"))), ["camera.u1", "camera.u2"]);
        // and is all that there is, where nothing else disagrees
        let alone = one_off(0.05, Some("camera.u2"));
        assert!(alone.len() == 1 && alone[0].share == 1.0, "{alone:?}");
    }

    #[test]
    fn law_a_circle_in_another_light_does_not_put_others_off() {
        // 3 px, of which the level of all took one third off each
        let tip = AREAS.end - 1;
        let off = |signal: usize| if signal == tip { 2.0 } else { -1.0 };
        let all = told(&|signal| if AREAS.contains(&signal) { 0.99 * off(signal) } else { NOISE }, ELSEWHERE);
        assert!(all.len() == 1 && all[0].signal == "camera.area3", "{all:?}");
    }

    #[test]
    fn value_noise_in_use_counts_up_to_half_as_much_again_as_sensors_give() {
        let signals: Vec<Signal> = (0..3).map(signal).collect();
        let judged = |blamed| noise((&[1.0, 1.0, 0.0], &[1.4, 1.6, 9.0]), &signals, blamed);
        assert_eq!(judged(ELSEWHERE), [1.4, 1.0, 9.0]);
        assert_eq!(judged(Some("camera.u1")), [1.0, 1.0, 9.0]);
        assert_eq!(judged(None), [1.4, 1.6, 9.0]);
    }
}
