//! Cuts lines where they leave the range of an axis: drawn outside, they would run along the frame and look like data.

type Point = (f64, f64);

/// The parts of a line that lie between two values, cut where it crosses them. What only touches a limit from outside is no part.
pub(crate) fn clip(points: &[Point], (low, high): (f64, f64)) -> Vec<Vec<Point>> {
    if points.iter().all(|(_, value)| (low..=high).contains(value)) {
        return vec![points.to_vec()];
    }
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if from.1.max(to.1) < low || from.1.min(to.1) > high {
            continue;
        }
        // Where the way between the two comes closest to its ends without leaving the range.
        let within = |end: Point| {
            let limit = end.1.clamp(low, high);
            let share = (limit - from.1) / (to.1 - from.1);
            if limit == end.1 { end } else { (from.0 + share * (to.0 - from.0), limit) }
        };
        let (begin, end) = (within(from), within(to));
        if begin == end {
            continue;
        }
        match parts.last_mut() {
            Some(part) if part.last() == Some(&begin) => part.push(end),
            _ => parts.push(vec![begin, end]),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::clip;

    #[test]
    fn law_a_line_that_leaves_the_range_is_cut_there() {
        let points = [(0.0, 0.0), (1.0, 0.5), (2.0, 100.0), (3.0, 0.5), (4.0, -100.0), (5.0, 100.0)];
        let parts = clip(&points, (-1.0, 1.0));
        assert_eq!(parts.len(), 3, "{parts:?}");
        assert!(parts.iter().flatten().all(|(_, value)| (-1.0..=1.0).contains(value)));
        let (left, value) = parts[0][2];
        assert!(value == 1.0 && (1.0..1.1).contains(&left), "cut where it crosses, not at the next point");
        assert_eq!(parts[2].len(), 2, "a line that only passes through is drawn from edge to edge");
    }

    #[test]
    fn value_parts_begin_and_end_where_the_line_crosses() {
        // In at (10.5, 1), out at (12.25, 3), in at (12.75, 3), to the end.
        let line = [(10.0, 0.0), (11.0, 2.0), (12.0, 2.0), (12.5, 4.0), (13.0, 2.0)];
        let parts =
            [vec![(10.5, 1.0), (11.0, 2.0), (12.0, 2.0), (12.25, 3.0)], vec![(12.75, 3.0), (13.0, 2.0)]];
        assert_eq!(clip(&line, (1.0, 3.0)), parts);
        // The same upside down.
        let mirrored = |points: &[(f64, f64)]| points.iter().map(|(x, y)| (*x, -*y)).collect::<Vec<_>>();
        assert_eq!(clip(&mirrored(&line), (-3.0, -1.0)), parts.map(|part| mirrored(&part)));
        // Right through, up and down, and past on either side.
        assert_eq!(clip(&[(1.0, -1.0), (3.0, 3.0)], (0.0, 1.0)), [[(1.5, 0.0), (2.0, 1.0)]]);
        assert_eq!(clip(&[(1.0, 3.0), (3.0, -1.0)], (0.0, 1.0)), [[(2.0, 1.0), (2.5, 0.0)]]);
        assert!(clip(&[(0.0, 5.0), (1.0, 7.0), (2.0, 6.0)], (0.0, 1.0)).is_empty());
        assert!(clip(&[(0.0, -5.0), (1.0, -7.0), (2.0, -6.0)], (0.0, 1.0)).is_empty());
    }

    #[test]
    fn value_a_point_on_the_limit_itself_begins_no_line_along_the_frame() {
        let line =
            [(0.0, 0.5), (1.0, 1.0), (2.0, 1.5), (3.0, 0.5), (4.0, 0.0), (5.0, -1.0), (6.0, 1.0), (7.0, 2.0)];
        let parts = [
            vec![(0.0, 0.5), (1.0, 1.0)],
            vec![(2.5, 1.0), (3.0, 0.5), (4.0, 0.0)],
            vec![(5.5, 0.0), (6.0, 1.0)],
        ];
        assert_eq!(clip(&line, (0.0, 1.0)), parts);
        assert!(clip(&[(0.0, 2.0), (1.0, 1.0), (2.0, 2.0)], (0.0, 1.0)).is_empty(), "a touch is no line");
        // What runs along the limit is data.
        let along = [(0.0, 1.0), (1.0, 1.0), (2.0, 3.0)];
        assert_eq!(clip(&along, (0.0, 1.0)), [[(0.0, 1.0), (1.0, 1.0)]]);
    }
}
