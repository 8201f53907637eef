//! Which circle is which: circle 1 rolls on the ground, and a link is as long as it is.

use super::{Facts, Finding};
use crate::rigs::acrobot::dataset::{Nominal, Table};
use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;

/// Where circles are in a frame, px.
type Frame = [[f64; 2]; 3];

/// Circles that may be taken for each other: what `[log]` must say, and their places.
const WAYS: [(&str, [usize; 2]); 3] = [
    ("circles = \"2 and 3 swapped\"", [1, 2]),
    ("circles = \"1 and 2 swapped\"", [0, 1]),
    ("circles = \"1 and 3 swapped\"", [0, 2]),
];

/// Two circles whose columns are exchanged in all runs: so no circle 1 rolls, or no link is as long as it should be. Rows in which a vision took one
/// for the other are put aside one by one.
pub(super) fn exchanged(facts: &Facts<'_>) -> Option<Finding> {
    let cameras = || {
        let logged = facts.runs.iter().filter_map(|run| Some((run, run.camera.as_ref()?)));
        logged.filter(|(_, camera)| !camera.is_empty())
    };
    let (run, camera) = cameras().next()?;
    let frames: Vec<Frame> = cameras().flat_map(|(_, camera)| frames(camera)).collect();
    // upside down links of one length look the same from either end: that is a matter of pixels
    let down: Vec<Frame> = frames.iter().map(|frame| frame.map(|[u, v]| [u, -v])).collect();
    if frames.len() < PLAUSIBLE.frames || fits(&frames, &facts.nominal)? || fits(&down, &facts.nominal)? {
        return None;
    }
    let read = |circles: [usize; 2]| {
        let mut other = frames.clone();
        other.iter_mut().for_each(|frame| frame.swap(circles[0], circles[1]));
        fits(&other, &facts.nominal)
    };
    let (add, circles) = WAYS.into_iter().find(|way| read(way.1) == Some(true))?;
    let [one, other] = circles.map(|place| place + 1);
    Some(Finding {
        file: format!("{}/camera.csv", run.name),
        line: camera.line[0],
        sentence: format!(
            "circles {one} and {other} look exchanged (columns u{one}, v{one} and u{other}, v{other}): only so does circle 1 roll on the \
             ground, and are both links as long as the nominal camera shows them"
        ),
        add: add.into(),
    })
}

/// The frames in which all circles were found.
fn frames(camera: &Table) -> Vec<Frame> {
    let columns = [["u1", "v1"], ["u2", "v2"], ["u3", "v3"]].map(|pair| pair.map(|name| camera.column(name)));
    let cell = |column: Option<&[f64]>, row: usize| column.map_or(f64::NAN, |values| values[row]);
    let all = (0..camera.len()).map(|row| columns.map(|pair| pair.map(|column| cell(column, row))));
    all.filter(|frame| frame.iter().flatten().all(|value| value.is_finite())).collect()
}

/// Whether circle 1 rolls and links have their lengths, in the middle of all frames; `None` where the mount is turned.
fn fits(frames: &[Frame], nominal: &Nominal) -> Option<bool> {
    let middle = |of: &dyn Fn(&Frame) -> f64| {
        let mut values: Vec<f64> = frames.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let rolls = (middle(&|frame| frame[0][1]) - nominal.ground?).abs() < PLAUSIBLE.near;
    let as_long = |link: usize| {
        let length = middle(&|frame| {
            let [from, to] = [frame[link], frame[link + 1]];
            f64::hypot(to[0] - from[0], to[1] - from[1])
        });
        (length / nominal.links[link] - 1.0).abs() < PLAUSIBLE.length
    };
    Some(rolls && as_long(0) && as_long(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::Run;

    /// What is told of 40 frames of an arm that sways upright, its links so many times as long, with circles in this order.
    fn told(order: [usize; 3], times: f64) -> Option<String> {
        told_of(order, times, [160.0, 180.0], 1.0)
    }

    /// The same of other links, px, with v counted so.
    fn told_of(order: [usize; 3], times: f64, links: [f64; 2], up: f64) -> Option<String> {
        let frame = |row: usize| {
            let (q1, q2) = (0.2 * libm::sin(row as f64), 0.3 * libm::cos(row as f64));
            let joint = [times * links[0] * libm::sin(q1), times * links[0] * libm::cos(q1) - 180.0];
            let tip =
                [joint[0] + times * links[1] * libm::sin(q2), joint[1] + times * links[1] * libm::cos(q2)];
            [[0.0, -180.0], joint, tip].map(|[u, v]| [u, up * v])
        };
        let columns = (0..3).flat_map(|circle| {
            let of = |axis: usize| (0..40).map(|row| frame(row)[order[circle]][axis]).collect();
            [(format!("u{}", circle + 1), of(0)), (format!("v{}", circle + 1), of(1))]
        });
        let time = (0..40).map(|row| f64::from(row) / 30.0).collect();
        let camera = Some(Table::new(time, columns.collect()));
        let runs = [Run { name: "run-01".into(), camera, controller: None, plant: None }];
        let nominal = Nominal {
            falling: [7.0, 7.0],
            gravity: 1.0,
            image: (512.0, 512.0),
            interval: 1.0 / 30.0,
            ground: Some(-180.0),
            links,
        };
        exchanged(&Facts { runs: &runs, nominal, gaps_stated: false }).map(|found| found.add)
    }

    #[test]
    fn every_pair_of_circles_that_is_exchanged_is_told_with_its_line() {
        assert_eq!(told([0, 1, 2], 1.0), None);
        for (order, [one, other]) in [([0, 2, 1], [2, 3]), ([1, 0, 2], [1, 2]), ([2, 1, 0], [1, 3])] {
            assert_eq!(told(order, 1.0), Some(format!("circles = \"{one} and {other} swapped\"")));
        }
        // two pairs are no habit of a vision that was set up
        assert_eq!(told([1, 2, 0], 1.0), None);
    }

    #[test]
    fn every_image_that_counts_v_down_is_left_to_the_check_of_pixels() {
        let told = |links: [f64; 2]| told_of([0, 1, 2], 1.0, links, -1.0);
        assert_eq!([told([160.0, 180.0]), told([170.0, 170.0])], [None, None]);
    }

    #[test]
    fn value_links_that_are_a_tenth_longer_are_others() {
        assert_eq!(
            [0.89, 0.91, 1.09, 1.11].map(|times| told([0, 2, 1], times).is_some()),
            [false, true, true, false]
        );
    }
}
