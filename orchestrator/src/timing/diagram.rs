//! When units have their points and which values go where, over a short time: what a timing diagram shows.

use super::Schedule;
use crate::algorithm::Sees;
use crate::error::Error;
use crate::scenario::Scenario;
use crate::simulation::Simulation;
use std::collections::BTreeSet;

/// Intervals of the slowest unit that are shown, after the first one.
const SHOWN: i64 = 2;

/// Points of a lane and ways between two units beyond which they are left out: nobody could tell them apart.
const MANY: i64 = 120;

/// A unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Lane {
    /// Its name.
    pub unit: String,
    /// Its points in s; none where there are too many.
    pub points: Vec<f64>,
    /// Interval in s.
    pub interval: f64,
}

/// The first use of a value, as it would be without jitter and losses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// Lane of the sender, and when it was sent, in s.
    pub from: (usize, f64),
    /// Lane of the receiver, and the point at which it takes it.
    pub to: (usize, f64),
}

/// A timing diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagram {
    /// Begin and end in s.
    pub span: (f64, f64),
    /// The units in the order of the scenario.
    pub lanes: Vec<Lane>,
    /// Values on their way.
    pub arrows: Vec<Arrow>,
}

/// The timing of a scenario from its start on.
///
/// # Errors
/// If the times of the scenario have no common tick.
pub fn diagram(scenario: &Scenario) -> Result<Diagram, Error> {
    in_order(scenario, 0..scenario.units.len())
}

/// That of a simulation, whose units may step in another order than the scenario's.
///
/// # Errors
/// None: it has a common tick.
pub fn diagram_of(simulation: &Simulation) -> Result<Diagram, Error> {
    in_order(simulation.scenario(), simulation.order().iter().copied())
}

fn in_order(scenario: &Scenario, order: impl IntoIterator<Item = usize>) -> Result<Diagram, Error> {
    let schedule = Schedule::of(scenario, order)?;
    let slowest = schedule.units.iter().map(|(interval, _)| *interval).max().unwrap_or(1);
    let latest = schedule.ways.iter().map(|way| way.latency).max().unwrap_or(0);
    // Half of the range of ticks is left for such sums.
    let end = (schedule.start + SHOWN * slowest.min(i64::MAX / 8) + latest.min(slowest)).min(schedule.stop);
    let seconds = |ticks: i64| ticks as f64 * schedule.tick;
    let lanes = scenario
        .units
        .iter()
        .zip(&schedule.units)
        .map(|(unit, (interval, _))| unit_lane(unit.name.clone(), seconds(*interval)));
    let mut lanes: Vec<Lane> = lanes.collect();
    for (unit, lane) in lanes.iter_mut().enumerate() {
        lane.points = schedule.points(unit, end).map(seconds).collect();
    }
    let mut arrows: BTreeSet<(usize, i64, usize, i64)> = BTreeSet::new();
    for way in &schedule.ways {
        let mut last = None;
        for point in schedule.points(way.to, end) {
            // With Gauss-Seidel the first step takes what there is at its end.
            if schedule.sees != Sees::Begin && point == schedule.start {
                continue;
            }
            let by = point - way.latency - i64::from(schedule.misses(way));
            let Some(sent) = schedule.last_point(way.from, by) else { continue };
            if last != Some(sent) {
                arrows.insert((way.from, sent, way.to, point));
            }
            last = Some(sent);
        }
    }
    let arrow = |(from, sent, to, taken): (usize, i64, usize, i64)| Arrow {
        from: (from, seconds(sent)),
        to: (to, seconds(taken)),
    };
    let arrows = arrows.into_iter().map(arrow).collect();
    Ok(Diagram { span: (seconds(schedule.start), seconds(end)), lanes, arrows })
}

fn unit_lane(unit: String, interval: f64) -> Lane {
    Lane { unit, points: Vec::new(), interval }
}

impl Schedule {
    /// The points of a unit up to a time; none where there are too many to be shown.
    fn points(&self, unit: usize, end: i64) -> impl Iterator<Item = i64> {
        let (interval, offset) = self.units[unit];
        let first = self.start + offset;
        let count = if end < first { 0 } else { (end - first) / interval + 1 };
        let start = (offset > 0).then_some(self.start);
        let shown = if count > MANY { 0 } else { count };
        start.into_iter().chain((0..shown).map(move |k| first + k * interval))
    }

    /// The last point of a unit that is not later than a time.
    fn last_point(&self, unit: usize, by: i64) -> Option<i64> {
        let (interval, offset) = self.units[unit];
        match by - self.start - offset {
            since @ 0.. => Some(by - since % interval),
            _ => (by >= self.start).then_some(self.start),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_two_units_and_a_way_back() {
        let scenario = |algorithm: &str| {
            let text = format!(
                "format = 1\nexperiment = {{ stop = 9, algorithm = \"{algorithm}\" }}\n\
                 [[units]]\nname = \"a\"\nfmu = \"x.fmu\"\ninterval = 0.5\n\
                 [[units]]\nname = \"b\"\nfmu = \"x.fmu\"\ninterval = 1\noffset = 0.25\n\
                 [[connections]]\nfrom = \"a.y\"\nto = \"b.u\"\n\
                 [[connections]]\nfrom = \"b.y\"\nto = \"a.u\"\nlatency = 0.5\n"
            );
            diagram(&Scenario::parse(&text, "test.toml").expect("a scenario")).expect("ticks")
        };
        let found = scenario("jacobi");
        assert_eq!(found.span, (0.0, 2.5));
        assert_eq!(found.lanes[0].points, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
        assert_eq!(found.lanes[1].points, [0.0, 0.25, 1.25, 2.25]);
        let ways: Vec<_> = found.arrows.iter().map(|arrow| (arrow.from, arrow.to)).collect();
        let expected = [
            ((0, 0.0), (1, 0.0)),
            ((0, 1.0), (1, 1.25)),
            ((0, 2.0), (1, 2.25)),
            ((1, 0.0), (0, 0.5)),
            ((1, 0.25), (0, 1.0)),
            ((1, 1.25), (0, 2.0)),
        ];
        assert_eq!(ways, expected);
        // The same two seconds later.
        let later = {
            let text = "format = 1\nexperiment = { start = 2, stop = 9, algorithm = \"jacobi\" }\n\
                        [[units]]\nname = \"a\"\nfmu = \"x.fmu\"\ninterval = 0.5\n\
                        [[units]]\nname = \"b\"\nfmu = \"x.fmu\"\ninterval = 1\noffset = 0.25\n\
                        [[connections]]\nfrom = \"a.y\"\nto = \"b.u\"\n\
                        [[connections]]\nfrom = \"b.y\"\nto = \"a.u\"\nlatency = 0.5\n";
            diagram(&Scenario::parse(text, "test.toml").expect("a scenario")).expect("ticks")
        };
        assert_eq!(later.span, (2.0, 4.5));
        assert_eq!(later.lanes[1].points, [2.0, 2.25, 3.25, 4.25]);
        let ways: Vec<_> = later.arrows.iter().map(|arrow| (arrow.from, arrow.to)).collect();
        let shifted = expected.map(|((from, sent), (to, taken))| ((from, sent + 2.0), (to, taken + 2.0)));
        assert_eq!(ways, shifted);
        // A run that ends with the first point of b.
        let text = "format = 1\nexperiment = { stop = 0.25 }\n[[units]]\nname = \"b\"\nfmu = \"x.fmu\"\ninterval = 1\noffset = 0.25\n";
        let short = diagram(&Scenario::parse(text, "test.toml").expect("a scenario")).expect("ticks");
        assert_eq!(short.lanes[0].points, [0.0, 0.25]);
        // Gauss-Seidel takes what there is at the end of a step: nothing at the start.
        assert_eq!(scenario("gauss-seidel").arrows[0].to, (1, 0.25));
    }

    #[test]
    fn value_a_unit_that_steps_later_is_seen_a_step_later() {
        let text = "format = 1\nexperiment = { stop = 9, algorithm = \"gauss-seidel\" }\n\
                    [[units]]\nname = \"a\"\nfmu = \"x.fmu\"\ninterval = 1\n\
                    [[units]]\nname = \"b\"\nfmu = \"x.fmu\"\ninterval = 1\n\
                    [[connections]]\nfrom = \"a.y\"\nto = \"b.u\"\n\
                    [[connections]]\nfrom = \"b.y\"\nto = \"a.u\"\n";
        let found = diagram(&Scenario::parse(text, "test.toml").expect("a scenario")).expect("ticks");
        let ways: Vec<_> = found.arrows.iter().map(|arrow| (arrow.from, arrow.to)).collect();
        // a steps first: what b sends at a point comes to a at the next one.
        let expected =
            [((0, 1.0), (1, 1.0)), ((0, 2.0), (1, 2.0)), ((1, 0.0), (0, 1.0)), ((1, 1.0), (0, 2.0))];
        assert_eq!(ways, expected);
    }
}
