//! Laws that a signal of the image may stay off by: of its circle's place, of its motion, of time, or of the pose.

use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::{CENTROIDS, circle_of};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::ROUNDING;
use crate::statistics::linear::{Cell, Drawn};
use nalgebra::{DMatrix, DVector};

/// One row of a signal: its residual, where the model renders it, the angles of the arm, and the time.
struct Row {
    residual: f64,
    drawn: Drawn,
    angles: [f64; 2],
    time: f64,
}

impl Row {
    /// Square of the distance from the image centre.
    fn squared(&self) -> f64 {
        let [u, v] = self.drawn.place;
        u * u + v * v
    }
}

/// What a law depends on.
#[derive(Clone, Copy)]
enum On {
    Nothing,
    Place(&'static [&'static str]),
    Motion,
    MotionAnd(&'static str),
    Pose,
    Time,
}

impl On {
    /// By name, for a signal of one of the circles: 0 at the drum, 1 at the joint, 2 at the tip.
    fn names(self, circle: usize) -> Vec<String> {
        let links = if circle < 2 { 1 } else { 2 };
        let angles = |of: [&str; 2]| of[..links].iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let rates = angles(["dq1", "dq2"]);
        match self {
            On::Nothing => Vec::new(),
            On::Place(names) => names.iter().map(|name| (*name).to_owned()).collect(),
            On::Motion => rates,
            On::MotionAnd(more) => rates.into_iter().chain([more.to_owned()]).collect(),
            On::Pose => angles(["q1", "q2"]),
            On::Time => vec!["time".to_owned()],
        }
    }
}

/// A law in words, and its value in a row. `axis` is 0 for values along u, 1 along v.
type Simple = (On, &'static str, fn(row: &Row, axis: usize) -> f64);

/// Simple laws of a residual of the image.
const LAWS: [Simple; 9] = [
    (On::Nothing, "constant: this circle sits elsewhere than the model has it", |_, _| 1.0),
    (On::Place(&["u"]), "linear in u", |row, _| row.drawn.place[0]),
    (On::Place(&["v"]), "linear in v", |row, _| row.drawn.place[1]),
    (On::Place(&["u", "v"]), "with the square of the distance from the centre", |row, _| row.squared()),
    (
        On::Place(&["u", "v"]),
        "along the radius, with the cube of the distance from the centre: as by a lens",
        |row, axis| row.squared() * row.drawn.place[axis],
    ),
    (On::Motion, "with the motion: a matter of time, the same all along", |row, _| row.drawn.rate),
    (
        On::MotionAnd("v"),
        "with motion times height in the image: rows exposed one after the other",
        |row, _| row.drawn.rate * row.drawn.place[1],
    ),
    (On::MotionAnd("time"), "with motion times time: clocks that drift apart", |row, _| {
        row.drawn.rate * row.time
    }),
    (On::Time, "drifting with time", |row, _| row.time),
];

/// A law of a signal, and how much of its residual it takes away.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ImageLaw {
    pub(super) share: f64,
    pub(super) depends_on: Vec<String>,
    pub(super) words: &'static str,
}

/// The simple law that takes most of a signal's residual away.
pub(super) fn law_of_image(at: &Evaluation, signal: usize) -> Option<ImageLaw> {
    let rows = rows(at, signal);
    let circle = circle_of(signal);
    let axis = if CENTROIDS.contains(&signal) { (signal - CENTROIDS.start) % 2 } else { 0 };
    let simple = LAWS.iter().filter_map(|(on, words, value)| {
        let column = DVector::from_iterator(rows.len(), rows.iter().map(|row| value(row, axis)));
        Some(ImageLaw { share: share(&rows, &[column])?, depends_on: on.names(circle), words })
    });
    simple.max_by(|a, b| a.share.total_cmp(&b.share))
}

/// What a smooth function of the pose takes of a signal's residual away. It has many coefficients, and does as well what an angle of the log
/// that is off does.
pub(super) fn law_of_pose(at: &Evaluation, signal: usize) -> Option<ImageLaw> {
    let rows = rows(at, signal);
    let circle = circle_of(signal);
    let share = share(&rows, &monomials(&rows, circle))?;
    let words = "a smooth function of the pose, as by a lens or a circle's place";
    Some(ImageLaw { share, depends_on: On::Pose.names(circle), words })
}

/// All rows of a signal that are of one moment.
fn rows(at: &Evaluation, signal: usize) -> Vec<Row> {
    let cells = at.blocks.iter().flat_map(|block| &block.cells);
    let of = |cell: &Cell| {
        let row = cell.signal.iter().position(|own| *own == signal)?;
        let [q1, q2, ..] = cell.state[..] else { return None };
        let drawn = *cell.drawn.get(row)?;
        Some(Row { residual: cell.residual[row], drawn, angles: [q1, q2], time: cell.time[row] })
    };
    cells.filter_map(of).collect()
}

/// Monomials of the angles that move a circle, as high as a surface over the poses goes.
fn monomials(rows: &[Row], circle: usize) -> Vec<DVector<f64>> {
    let most = IMAGES.degree as i32;
    let second = if circle < 2 { 0 } else { most };
    let powers = (0..=most).flat_map(|a| (0..=second.min(most - a)).map(move |b| (a, b)));
    let of = |(a, b): (i32, i32)| {
        let value = |row: &Row| row.angles[0].powi(a) * row.angles[1].powi(b);
        DVector::from_iterator(rows.len(), rows.iter().map(value))
    };
    powers.map(of).collect()
}

/// Share of the residual's squares that some columns take away, each beside those before it; nothing where nothing is left.
fn share(rows: &[Row], columns: &[DVector<f64>]) -> Option<f64> {
    let residual = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.residual));
    let mut basis = DMatrix::<f64>::zeros(rows.len(), 0);
    for column in columns {
        let beside = column - &basis * basis.tr_mul(column);
        let length = beside.norm();
        if length > ROUNDING * column.norm() {
            let place = basis.ncols();
            basis = basis.insert_column(place, 0.0);
            basis.set_column(place, &(beside / length));
        }
    }
    let square = residual.norm_squared();
    (square > 0.0).then(|| basis.tr_mul(&residual).norm_squared() / square)
}

#[cfg(test)]
mod tests {
    use super::super::examples::{Moment, frames, place, rate};
    use super::*;

    /// u of the tip.
    const TIP: usize = CENTROIDS.end - 2;

    /// Frames in which a model leaves so much of the tip's u, beside noise.
    fn left(of: impl Fn(&Moment) -> f64) -> Evaluation {
        frames(|moment, signal| if signal == TIP { of(moment) } else { 0.0 })
    }

    /// The simple law of that.
    fn told(of: impl Fn(&Moment) -> f64) -> ImageLaw {
        law_of_image(&left(of), TIP).expect("rows")
    }

    #[test]
    fn value_each_simple_law_is_told_where_it_holds() {
        let radial = told(|moment| {
            let [u, v] = place(TIP, moment.state);
            1e-6 * u * (u * u + v * v)
        });
        assert!(radial.words.starts_with("along the radius") && radial.share > 0.9, "{radial:?}");
        assert_eq!(radial.depends_on, ["u", "v"]);
        let late = told(|moment| 1e-3 * rate(TIP, moment.state));
        assert!(late.words.starts_with("with the motion:") && late.depends_on == ["dq1", "dq2"], "{late:?}");
        let drift = told(|moment| 0.01 * moment.time);
        assert!(drift.words == "drifting with time" && drift.depends_on == ["time"], "{drift:?}");
    }

    #[test]
    fn value_a_law_of_the_pose_that_is_none_of_the_simple_ones_is_told_as_that() {
        let at = left(|moment| {
            let [q1, q2, ..] = moment.state;
            10.0 * (q1 * q2 + 3.0 * q2 * q2 * q1)
        });
        let (pose, simple) = (law_of_pose(&at, TIP).expect("rows"), law_of_image(&at, TIP).expect("rows"));
        assert!(pose.share > 0.95 && simple.share < 0.6, "{pose:?} {simple:?}");
        assert_eq!(pose.depends_on, ["q1", "q2"]);
    }

    #[test]
    fn law_noise_follows_no_law() {
        // fifteen coefficients take 15 of 900 squares of noise, with a standard deviation of 5
        let at = left(|_| 0.0);
        assert!(law_of_pose(&at, TIP).expect("rows").share < 0.05);
        assert!(law_of_image(&at, TIP).expect("rows").share < 0.05);
    }
}
