//! Light that changes for a while: a lamp, a cloud, a camera that sets its exposure by itself. The areas of all circles go together then, whatever
//! the arm does, and lie as the model has them at other times.

use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::residual::Block;
use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::AREAS;
use crate::statistics::levels::{CERTAIN, HALF, ROWS};
use crate::statistics::linear::Cell;
use crate::statistics::median::median;

/// Such a light, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() {
        return Judgement::Keep;
    }
    let told = changing(&found.study.last.blocks).map(|while_off| Unknown {
        signal: found.signals[AREAS.start].name.clone(),
        depends_on: vec!["time".into()],
        shape: while_off.words(found.runs),
        nearest: nearest(found.study, found.list),
        ..Unknown::default()
    });
    told.into()
}

/// All circles' areas in a few frames on end, against what they are at most times.
#[derive(Debug, Clone, Copy, PartialEq)]
struct WhileOff {
    run: usize,
    /// The middle of it, s.
    time: f64,
    /// By how much all are larger than usual, px.
    by: f64,
    /// How surely.
    deviations: f64,
}

impl WhileOff {
    fn words(self, runs: &[String]) -> String {
        let than = if self.by < 0.0 { "smaller" } else { "larger" };
        let run = runs.get(self.run).map_or("", String::as_str);
        format!(
            "all circles are {:.1} px {than} for a while, about {:.1} s in {run} ({:.1} standard deviations): light that changes, or a camera \
             that sets its exposure by itself",
            self.by.abs(),
            self.time,
            self.deviations.abs()
        )
    }
}

/// What is left of a frame's areas: its run, its time, and the residual of each circle's.
struct Frame {
    run: usize,
    time: f64,
    areas: [f64; AREAS.end - AREAS.start],
}

impl Frame {
    /// A frame in which all areas were measured.
    fn of(run: usize, cell: &Cell) -> Option<Self> {
        let row = |area: usize| cell.signal.iter().position(|signal| *signal == AREAS.start + area);
        let mut areas = [0.0; AREAS.end - AREAS.start];
        for (area, left) in areas.iter_mut().enumerate() {
            *left = cell.residual[row(area)?];
        }
        Some(Self { run, time: *cell.time.first()?, areas })
    }

    fn level(&self) -> f64 {
        self.areas.iter().sum::<f64>() / self.areas.len() as f64
    }
}

/// The frames on end in which all areas lie farthest off, if that is beyond noise and beyond what right renderers make of an arm that stands still.
fn changing(blocks: &[Block]) -> Option<WhileOff> {
    let frames =
        blocks.iter().flat_map(|block| block.cells.iter().filter_map(|cell| Frame::of(block.run, cell)));
    let frames: Vec<Frame> = frames.collect();
    let usual = median(frames.iter().map(Frame::level))?;
    let next = frames.windows(2).filter(|pair| pair[0].run == pair[1].run);
    let (sum, pairs) = next.fold((0.0, 0.0), |(sum, pairs), pair| {
        let change = pair[1].level() - pair[0].level();
        (sum + change * change, pairs + 1.0)
    });
    // neighbours differ by the noise of both (von Neumann)
    let noise = (HALF * sum / pairs / ROWS as f64).sqrt();
    let off = |few: &[Frame]| {
        let mean = |of: &dyn Fn(&Frame) -> f64| few.iter().map(of).sum::<f64>() / few.len() as f64;
        let by = mean(&Frame::level) - usual;
        let each = (0..AREAS.len()).map(|area| mean(&|frame: &Frame| frame.areas[area]) - usual);
        let together = each.into_iter().all(|own| own * by.signum() > HALF * by.abs());
        let one_run = few.iter().all(|frame| frame.run == few[0].run);
        let told = WhileOff { run: few[0].run, time: few[few.len() / 2].time, by, deviations: by / noise };
        (one_run && together).then_some(told)
    };
    let all = frames.windows(ROWS).filter_map(off);
    let most = all.max_by(|one, other| one.by.abs().total_cmp(&other.by.abs()))?;
    (most.by.abs() > IMAGES.level && most.deviations.abs() > 2.0 * CERTAIN).then_some(most)
}

#[cfg(test)]
mod tests {
    use super::super::examples::frames;
    use super::*;

    /// What is told where areas are off by so much, by time and circle.
    fn told(off: impl Fn(f64, usize) -> f64) -> Option<WhileOff> {
        let at = frames(
            |moment, signal| {
                if AREAS.contains(&signal) { off(moment.time, signal - AREAS.start) } else { 0.0 }
            },
        );
        changing(&at.blocks)
    }

    #[test]
    fn law_light_that_falls_for_some_seconds_is_told_with_its_time() {
        let fall = |time: f64| if time > 12.0 { -4.0 * libm::exp(-(time - 12.0) / 2.0) } else { 0.0 };
        let fallen = told(|time, _| fall(time)).expect("4 px are told");
        assert!((-4.5..-2.5).contains(&fallen.by) && (12.0..13.0).contains(&fallen.time), "{fallen:?}");
        let words = fallen.words(&["run-01".into()]);
        assert!(
            words.starts_with("all circles are ") && words.contains(" px smaller for a while, about 12."),
            "{words}"
        );
    }

    #[test]
    fn law_noise_a_level_and_one_circle_alone_are_no_such_light() {
        assert_eq!(told(|_, _| 0.0), None);
        assert_eq!(told(|_, _| 3.0), None, "all the time");
        assert_eq!(told(|time, circle| if time < 3.0 && circle == 2 { 9.0 } else { 0.0 }), None);
    }

    #[test]
    fn value_a_change_counts_beyond_what_right_renderers_make() {
        let off = |by: f64| told(|time, _| if time < 3.0 { by } else { 0.0 }).is_some();
        // noise of a frame's mean is 0.58 px, and 0.17 px of twelve: nine deviations are 1.5 px
        assert!(!off(0.8) && off(2.5));
    }
}
