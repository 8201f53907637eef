//! What a residual looks like: the simple law of state, place or time that takes most of it away. Torques stand here, images in `image_shape`.

use super::image_laws::law_of_image;
use super::image_shape::image_shape;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::gap::measures;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::studio::{ANGLES, CENTROIDS};
use crate::rigs::acrobot::residual::torque::{LACKING, torques};
use crate::rigs::acrobot::selection::{Evaluation, Study};
use crate::rigs::acrobot::simple_laws::{Moment, OF_STATE};
use crate::statistics::levels::{HALF, PART};

/// What of the list comes nearest to it.
pub(super) fn nearest(study: &Study, candidates: &[Candidate]) -> String {
    let total = study.last.total.square.max(1.0);
    match study.screen.hits.iter().find(|hit| !study.active.contains(&hit.candidate)) {
        Some(hit) => format!(
            "{} ({}) comes nearest, but takes away only {:.1} % of what is left",
            candidates[hit.candidate].name,
            candidates[hit.candidate].phrase,
            100.0 * hit.gain / total
        ),
        None => "no listed effect resembles it".into(),
    }
}

/// Names of what a law depends on, and its form.
pub(super) type Form = (&'static [&'static str], &'static str);

/// Which of the lacking torques a signal is.
pub fn link_of(signal: &str) -> Option<usize> {
    LACKING.iter().position(|name| *name == signal)
}

/// What torques that lack look like.
struct Torques {
    /// The simple law that takes most of one link's squares away, with the share of them, and the link.
    best: Option<(f64, usize, Form)>,
    /// Sum of squares of each link's torques, (N·m)².
    squares: [f64; 2],
    /// Where few windows hold most of it, which is an event and no law.
    event: Option<Held>,
}

/// What few windows hold.
#[derive(Debug, Clone, Copy)]
struct Held {
    /// Their share of all squares.
    share: f64,
    /// The block of the largest.
    largest: usize,
    /// These windows follow one another in one run.
    at_once: bool,
}

/// Finds the law, and whether few windows hold nearly all of it, which is an event.
fn law_of_torques(study: &Study, at: &Evaluation) -> Torques {
    let lacking = torques(&at.blocks, &[], &[], &study.folds.of);
    let mut best: Option<(f64, usize, Form)> = None;
    let mut squares = [0.0; 2];
    for (link, square) in squares.iter_mut().enumerate() {
        let values: Vec<(f64, Moment)> = lacking
            .iter()
            .filter(|t| t.floor[link].is_finite())
            .map(|t| {
                let block = &at.blocks[t.block];
                let time = 0.5 * (block.from + block.to);
                (t.torque[link], Moment { run: block.run, state: block.state, time, tau: 0.0 })
            })
            .collect();
        let total: f64 = values.iter().map(|(x, ..)| x * x).sum();
        *square = total;
        for law in &OF_STATE {
            let (mut xy, mut xx) = (0.0, 0.0);
            for (y, moment) in &values {
                let x = law.value(moment);
                xy += x * y;
                xx += x * x;
            }
            let share = if xx > 0.0 && total > 0.0 { xy * xy / xx / total } else { 0.0 };
            if best.is_none_or(|(known, ..)| share > known) {
                best = Some((share, link, (law.depends_on, &*law.words)));
            }
        }
    }
    let mut sizes: Vec<(f64, usize)> =
        lacking.iter().map(|t| (t.torque.iter().map(|x| x * x).sum::<f64>(), t.block)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let few = sizes.len().div_ceil(20);
    let share: f64 = sizes[..few].iter().map(|(size, _)| size).sum::<f64>()
        / sizes.iter().map(|(s, _)| s).sum::<f64>().max(1e-300);
    let event = sizes.first().filter(|_| share > 0.8).map(|(_, largest)| {
        let near =
            |block: usize| at.blocks[block].run == at.blocks[*largest].run && block.abs_diff(*largest) <= few;
        let (near, all) = sizes[..few].iter().fold((0.0, 0.0), |(near_by, all), (size, block)| {
            (near_by + if near(*block) { *size } else { 0.0 }, all + size)
        });
        Held { share, largest: *largest, at_once: near > 0.8 * all }
    });
    Torques { best, squares, event }
}

/// Which signal is off, in words, on what it depends, and its form in words.
pub fn torque_shape(study: &Study, at: &Evaluation) -> (String, Vec<String>, String) {
    let Torques { best, squares, event } = law_of_torques(study, at);
    let link = if squares[0] > squares[1] { 0 } else { 1 };
    let signal = |link: usize| LACKING[link].to_owned();
    match (event, best) {
        (Some(held), _) => {
            let largest = held.largest;
            let block = &at.blocks[largest];
            let shape = if held.at_once {
                format!(
                    "an event, {:.0} % of it in few windows around {:.1} s: a push from outside",
                    100.0 * held.share,
                    block.from
                )
            } else {
                format!(
                    "{:.0} % of it in few windows that lie apart, the largest at {:.1} s: pushes from outside, or rows of a log that are far off",
                    100.0 * held.share,
                    block.from
                )
            };
            (signal(link), vec!["time".into()], shape)
        }
        (None, Some((share, link, form))) if share > PART * HALF => {
            let (depends_on, shape) = law_in_words(share, form);
            (signal(link), depends_on, shape)
        }
        _ => (signal(link), Vec::new(), NO_LAW.into()),
    }
}

/// What is said where no law explains a torque.
const NO_LAW: &str = "no simple law of angles, rates or time";

/// On what a torque depends of which a law takes this share, and its form: one that leaves most of it says neither.
fn law_in_words(share: f64, (variables, words): Form) -> (Vec<String>, String) {
    if share > HALF {
        let depends_on = variables.iter().map(|name| (*name).to_owned()).collect();
        return (depends_on, format!("{words} ({:.0} % of it)", 100.0 * share));
    }
    (Vec::new(), format!("{NO_LAW}: the best takes {:.0} % of it", 100.0 * share))
}

/// Share of what a model leaves that one law takes away which is common to all runs: of the torques, or of the image's worst signal.
pub(super) fn common(study: &Study, at: &Evaluation, torque: bool) -> f64 {
    if torque {
        let Torques { best, squares, event } = law_of_torques(study, at);
        let all = squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let law = best.map_or(0.0, |(share, link, _)| share * squares[link] / all);
        return event.map_or(law, |held| held.share.max(law));
    }
    law_of_image(at, widest(at)).map_or(0.0, |law| law.share)
}

/// Where and how the nominal model misses the data.
pub(super) fn nominal_shape(
    study: &Study,
    signals: &[Signal],
    list: &[Candidate],
    torque: bool,
) -> Option<(String, Vec<String>, String)> {
    let nominal = &study.nominal;
    if torque {
        return Some(torque_shape(study, nominal));
    }
    Some(image_shape(nominal, widest(nominal), &study.noise, signals, list))
}

/// The centroid that a model misses most; where no circle was logged, the angle that was read off them.
pub(super) fn widest(at: &Evaluation) -> usize {
    let of = if measures(&at.blocks, &CENTROIDS) { CENTROIDS } else { ANGLES };
    let (start, most) = (of.start, |a: &usize, b: &usize| square(at, *a).total_cmp(&square(at, *b)));
    of.max_by(most).unwrap_or(start)
}

/// Sum of squares of one signal, in its unit.
pub(super) fn square(at: &Evaluation, signal: usize) -> f64 {
    let cells = at.blocks.iter().flat_map(|block| &block.cells);
    let rows = cells.flat_map(|cell| cell.signal.iter().zip(&cell.residual));
    rows.filter(|(own, _)| **own == signal).map(|(_, residual)| residual * residual).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_law_is_told_that_takes_more_than_half() {
        let form: Form = (&["q2"], "odd in q2, like a spring");
        let (depends_on, shape) = law_in_words(0.51, form);
        assert_eq!((depends_on.len(), shape.as_str()), (1, "odd in q2, like a spring (51 % of it)"));
        // a sixth of a torque is no spring
        let (depends_on, shape) = law_in_words(0.49, form);
        assert!(
            depends_on.is_empty() && !shape.contains("spring") && shape.ends_with("takes 49 % of it"),
            "{shape}"
        );
    }
}
