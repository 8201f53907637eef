//! Which rows are searched, and which are left out to judge what was found.

use super::policy::GENERAL;
use crate::dynamics::build::Span;
use crate::observe::{Problem, Role, Run};

/// Runs, each between two times, s.
pub(super) type Rows<'a> = Vec<(&'a Run, Span)>;

/// Rows that are searched and rows that are left out. Left out is the last run that a window fits into, beside another one; where there
/// is none, the last part of the longest run.
pub(super) fn parted(problem: &Problem) -> (Rows<'_>, Rows<'_>) {
    let runs = &problem.runs;
    let tells = |run: usize| rows(problem, &runs[run]) >= GENERAL.shortest_window;
    let mut telling = (0..runs.len()).rev().filter(|run| tells(*run));
    let (last, another) = (telling.next(), telling.next());
    let whole = |left: usize| -> Rows<'_> {
        let others = runs.iter().enumerate().filter(|(run, _)| *run != left);
        others.map(|(_, run)| (run, run.span())).collect()
    };
    if let (Some(last), Some(_)) = (last, another) {
        return (whole(last), vec![(&runs[last], runs[last].span())]);
    }
    // the first of those that are equally long
    let Some(longest) = (0..runs.len()).rev().max_by_key(|run| rows(problem, &runs[*run])) else {
        return (Vec::new(), Vec::new());
    };
    let one = &runs[longest];
    let (from, to) = one.span();
    let cut = cut(from, to);
    let mut kept = whole(longest);
    kept.insert(longest, (one, (from, cut)));
    (kept, vec![(one, (cut, to))])
}

/// Rows of a run in which an output was measured: those of the output that has most.
fn rows(problem: &Problem, run: &Run) -> usize {
    let outputs =
        problem.channels.iter().zip(&run.series).filter(|(channel, _)| channel.role == Role::Compared);
    outputs.map(|(_, series)| series.time.len()).max().unwrap_or(0)
}

/// Where the part of a single run begins that is left out, s.
pub(super) fn cut(from: f64, to: f64) -> f64 {
    to - GENERAL.left_out * (to - from)
}

#[cfg(test)]
mod tests {
    use super::parted;
    use crate::dynamics::tests::pendulum;
    use crate::observe::Problem;

    /// The pendulum's log in runs of so many rows.
    fn logged(rows: &[usize]) -> Problem {
        let mut problem = pendulum("parted", 60);
        let whole = problem.runs.remove(0);
        problem.runs = rows
            .iter()
            .map(|rows| {
                let mut run = whole.clone();
                run.name = rows.to_string();
                for series in &mut run.series {
                    series.time.truncate(*rows);
                    series.values.truncate(*rows);
                }
                run
            })
            .collect();
        problem
    }

    /// Rows of the runs that are searched and of those that are left out, and whether the latter are whole runs.
    fn named(rows: &[usize]) -> (Vec<usize>, Vec<usize>, bool) {
        let problem = logged(rows);
        let (kept, left) = parted(&problem);
        let names = |list: &[(&crate::observe::Run, (f64, f64))]| -> Vec<usize> {
            list.iter().map(|(run, _)| run.name.parse().expect("a number of rows")).collect()
        };
        (names(&kept), names(&left), left.iter().all(|(run, span)| *span == run.span()))
    }

    #[test]
    fn law_what_is_left_out_is_long_enough_to_be_judged() {
        assert_eq!(named(&[60, 50, 40]), (vec![60, 50], vec![40], true), "the last run");
        assert_eq!(named(&[60, 50, 2]), (vec![60, 2], vec![50], true), "two rows tell nothing of a motion");
        assert_eq!(named(&[60, 50, 11, 8]), (vec![60, 11, 8], vec![50], true), "nor do those of no window");
        // one run only is long enough: a part of it
        assert_eq!(named(&[60, 2]), (vec![60, 2], vec![60], false));
        assert_eq!(named(&[8, 60]), (vec![8, 60], vec![60], false));
        assert_eq!(named(&[60]), (vec![60], vec![60], false));
        assert_eq!(
            named(&[8, 8]),
            (vec![8, 8], vec![8], false),
            "no run is: a part of the first, and a gap of no window"
        );
    }
}
