//! What a residual of images looks like: single frames that show another moment, a value that swings, angles of the log that are off, or
//! a simple law of place, motion or time.

use super::frames::Frames;
use super::image_laws::{ImageLaw, law_of_image, law_of_pose};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::Evaluation;
use crate::rigs::acrobot::simple_laws::ANGLES_OF_LOG;
use crate::statistics::levels::{HALF, PART, SMALL};
use crate::statistics::linear::Cell;

/// The signal that is blamed, what its residual depends on, and its form.
pub(super) type Shape = (String, Vec<String>, String);

/// The shape of what a model leaves of images, the signal `worst` most of all. `noise` is what noise alone gives each signal: the scatter
/// that a model leaves hides in it what it lacks.
pub(super) fn image_shape(
    at: &Evaluation,
    worst: usize,
    noise: &[f64],
    signals: &[Signal],
    list: &[Candidate],
) -> Shape {
    let noise: Vec<f64> =
        noise.iter().zip(&at.sigmas).map(|(own, seen)| if *own > 0.0 { *own } else { *seen }).collect();
    let at = &at.with(&noise);
    let shape = |signal: &str, on: &[&str], shape: String| {
        (signal.to_owned(), on.iter().map(|name| (*name).to_owned()).collect(), shape)
    };
    let own = signals[worst].name.as_str();
    let frames = Frames::of(at);
    if let Some(text) = frames.single(at, list) {
        return shape(own, &["time"], text);
    }
    // of what noise doesn't leave
    let loud = 1.0 - quiet(at, worst, noise[worst]);
    let of_loud = |law: ImageLaw| ImageLaw { share: (law.share / loud).min(1.0), ..law };
    let law = law_of_image(at, worst).map(of_loud);
    let share = law.as_ref().map_or(0.0, |law| law.share);
    if let Some((link, angle)) = angle_of_log(at).filter(|(_, angle)| *angle > share.max(HALF)) {
        let name = ["q1", "q2"][link];
        let text = format!(
            "the log's {name} is off in proportion to itself, as by an encoder's scale ({:.0} % of it)",
            100.0 * angle
        );
        return shape(ANGLES_OF_LOG[link], &[name], text);
    }
    let swing = frames.swing(at, list).map(|swing| (frames.share(&swing), swing));
    if let Some((swung, swing)) = swing.filter(|(swung, _)| *swung > (share + SMALL).max(PART)) {
        let text = format!("{} ({:.0} % of it)", swing.words(list), 100.0 * swung);
        return shape(own, &["time"], text);
    }
    let pose = law_of_pose(at, worst).map(of_loud).filter(|pose| pose.share > share + SMALL);
    match pose.or(law).filter(|law| law.share > SMALL) {
        Some(ImageLaw { share, depends_on, words }) => {
            (own.to_owned(), depends_on, format!("{words} ({:.0} % of it)", 100.0 * share))
        }
        _ => shape(own, &[], "no simple law of place, motion or time".into()),
    }
}

/// Whether what has no name is in the angles of the log.
pub fn is_of_angles(left: &Unknown) -> bool {
    ANGLES_OF_LOG.contains(&left.signal.as_str())
}

/// The share of a signal's squares that noise leaves.
fn quiet(at: &Evaluation, signal: usize, noise: f64) -> f64 {
    let cells = at.blocks.iter().flat_map(|block| &block.cells);
    let rows = cells.flat_map(|cell| cell.signal.iter().zip(&cell.residual)).filter(|row| *row.0 == signal);
    let (square, count) = rows.fold((0.0, 0.0), |(sum, count), (_, rest)| (sum + rest * rest, count + 1.0));
    if square > 0.0 { (count * noise * noise / square).min(HALF) } else { 0.0 }
}

/// The link of whose angle in the log a share explains most of what noise doesn't leave of all circles, and how much of that. `None` where poses are
/// not those of a log.
fn angle_of_log(at: &Evaluation) -> Option<(usize, f64)> {
    let cells = || at.blocks.iter().flat_map(|block| &block.cells).filter(|cell| cell.soft.ncols() == 2);
    let white = |cell: &Cell, row: usize| cell.residual[row] / cell.sigma[row];
    let square =
        |cell: &Cell| (0..cell.residual.len()).map(|row| white(cell, row).powi(2) - 1.0).sum::<f64>();
    let more: f64 = cells().map(square).sum();
    let share = |link: usize| {
        let (mut xy, mut xx) = (0.0, 0.0);
        for cell in cells() {
            let angle = cell.state.get(link).copied().unwrap_or(0.0);
            for row in 0..cell.residual.len() {
                let x = angle * cell.soft[(row, link)] / cell.sigma[row];
                xy += x * white(cell, row);
                xx += x * x;
            }
        }
        if xx > 0.0 { (xy * xy / xx / more).min(1.0) } else { 0.0 }
    };
    let best = [0, 1].map(|link| (link, share(link))).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|_| more > 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::examples::{Moment, candidates, frames, moved, noise, read, signals};
    use super::super::torque_shape::widest;
    use super::*;
    use crate::rigs::acrobot::residual::studio::COLUMNS;
    use std::f64::consts::TAU;

    /// The shape of what is left, signal and text.
    fn told(left: impl Fn(&Moment, usize) -> f64) -> (String, String) {
        let at = frames(left);
        let noise: Vec<f64> = (0..COLUMNS.len()).map(noise).collect();
        let (signal, _, text) = image_shape(&at, widest(&at), &noise, &signals(), &candidates());
        (signal, text)
    }

    #[test]
    fn value_a_camera_that_swings_is_told_with_its_frequency() {
        let along_u = |signal: usize| if signal < 6 && signal.is_multiple_of(2) { 1.0 } else { 0.0 };
        let swings = |size: f64, hertz: f64| {
            told(move |moment, signal| size * along_u(signal) * libm::sin(TAU * hertz * moment.time))
        };
        for hertz in [0.4, 1.7, 11.3] {
            let (signal, text) = swings(0.1, hertz);
            assert!(signal.contains("camera.u"), "{signal}");
            let words = format!("swinging {hertz:.2} times a second, as if shift (moved along u) did");
            assert!(text.starts_with(&words), "{text}");
        }
    }

    #[test]
    fn value_frames_of_another_moment_are_told_by_their_number() {
        // the frame before once more, and two that were exchanged
        let late = |moment: &Moment| match moment.frame {
            120 | 500 => 1.0,
            300 => 1.0,
            301 => -1.0,
            _ => 0.0,
        };
        let (_, text) = told(|moment, signal| late(moment) / 30.0 * moved(moment, signal));
        assert!(
            text.starts_with("single frames, 4 of 900, the first at 4.00 s: they show another moment"),
            "{text}"
        );
        // spots that no motion gives
        let spot = |moment: &Moment| if moment.frame % 200 == 7 { 3.0 } else { 0.0 };
        let (_, text) = told(|moment, signal| if signal == 5 { spot(moment) } else { 0.0 });
        assert!(text.contains("5 of 900") && text.contains("don't show what the others do"), "{text}");
        // ten times the squares of nine rows' noise: 0.24 px on one of them
        let one =
            |size: f64| told(move |moment, signal| if signal == 5 && moment.frame == 7 { size } else { 0.0 });
        assert!(!one(0.18).1.starts_with("single") && one(3.0).1.starts_with("single frames, 1 of"));
    }

    #[test]
    fn value_an_encoder_that_reads_in_proportion_is_told_as_that() {
        let (signal, text) = told(|moment, signal| read(moment, signal, 0.02 * moment.state[1]));
        assert_eq!(signal, "plant.q2");
        assert!(text.starts_with("the log's q2 is off in proportion to itself"), "{text}");
        assert!(is_of_angles(&Unknown { signal, ..Unknown::default() }));
    }

    #[test]
    fn law_a_circle_that_sits_elsewhere_stays_one() {
        let (signal, text) = told(|_, signal| if signal == 5 { 0.3 } else { 0.0 });
        assert_eq!(signal, "camera.v3");
        assert!(text.starts_with("constant: this circle sits elsewhere"), "{text}");
    }
}
