//! The clock of a scenario: a tick of which all its times are whole multiples, and the odd steps at the ends of a run.

use crate::error::Error;
use crate::fmu::Description;
use crate::scenario::{Scenario, UnitEntry};
use crate::time::{Clock, Rational};

/// The times of a scenario in ticks.
pub(crate) struct Ticks {
    pub(crate) start: i64,
    pub(crate) stop: i64,
    pub(crate) intervals: Vec<i64>,
    pub(crate) offsets: Vec<i64>,
}

/// What is left between the last whole step of a unit and the stop.
#[derive(Clone, Copy)]
pub(super) struct Last {
    pub(super) ticks: i64,
    pub(super) size: Rational,
    /// The unit takes a shorter step to get there.
    pub(super) reaches_stop: bool,
}

impl Ticks {
    /// `None` where the stop is one of the unit's own points.
    pub(super) fn last(&self, unit: usize, description: &Description, clock: &Clock) -> Option<Last> {
        let (run, offset) = (self.stop - self.start, self.offsets[unit]);
        let ticks = if run < offset { run } else { (run - offset) % self.intervals[unit] };
        let tick = clock.tick();
        let size =
            Rational::new(i128::from(ticks) * i128::from(tick.numerator()), i128::from(tick.denominator()))?;
        let reaches_stop = description.co_simulation.can_handle_variable_step;
        (ticks > 0).then_some(Last { ticks, size, reaches_stop })
    }
}

/// What a person should know of a stop that is none of a unit's points.
pub(super) fn last_point(scenario: &Scenario, entry: &UnitEntry, last: Option<Last>) -> Option<String> {
    let Last { size, reaches_stop, .. } = last?;
    let (name, interval, stop) = (&entry.name, entry.interval, scenario.stop);
    let from =
        entry.offset.as_ref().map_or_else(String::new, |offset| format!(" from {} s on", offset.value));
    let off =
        format!("unit {name}: its interval of {interval} s{from} does not divide the run up to {stop} s:");
    Some(match reaches_stop {
        true => format!("{off} its last step has {size} s"),
        false => format!("{off} its last point lies {size} s before the stop, since its steps can't differ"),
    })
}

/// The first step of a unit whose points begin later than the start.
pub(super) fn first_step(
    entry: &UnitEntry,
    description: &Description,
    clock: &Clock,
) -> Result<Option<(i64, f64)>, Error> {
    let Some(offset) = &entry.offset else { return Ok(None) };
    if !description.co_simulation.can_handle_variable_step {
        return Err(Error::Scenario {
            place: offset.place.clone(),
            what: format!("offset = {} of unit {}", offset.value, entry.name),
            expected: "its first step would be shorter, and its steps can't differ \
                       (canHandleVariableCommunicationStepSize); leave the offset out"
                .into(),
        });
    }
    // A multiple: the clock was made from it.
    Ok(clock.ticks(offset.value).map(|ticks| (ticks, offset.value.to_f64())))
}

/// The common tick of all times.
pub(crate) fn clock(scenario: &Scenario) -> Result<(Clock, Ticks), Error> {
    let times = || {
        let units = scenario.units.iter().map(|unit| unit.interval);
        let delays = scenario.connections.iter().map(|connection| connection.delay);
        let offsets = scenario.units.iter().filter_map(|unit| Some(unit.offset.as_ref()?.value));
        [scenario.start, scenario.stop].into_iter().chain(units).chain(offsets).chain(delays)
    };
    let ticks = || {
        let clock = Clock::of(times())?;
        let intervals =
            scenario.units.iter().map(|unit| clock.ticks(unit.interval)).collect::<Option<_>>()?;
        let offset =
            |unit: &UnitEntry| unit.offset.as_ref().map_or(Some(0), |offset| clock.ticks(offset.value));
        let offsets = scenario.units.iter().map(offset).collect::<Option<_>>()?;
        let (start, stop) = (clock.ticks(scenario.start)?, clock.ticks(scenario.stop)?);
        let fits = |ticks: i64| clock.holds(ticks);
        let delays_fit = scenario.connections.iter().all(|c| clock.ticks(c.delay).is_some_and(fits));
        (fits(start) && fits(stop) && delays_fit)
            .then_some((clock, Ticks { start, stop, intervals, offsets }))
    };
    ticks().ok_or_else(|| {
        let mut all: Vec<String> = times().map(|time| time.to_string()).collect();
        all.sort();
        all.dedup();
        Error::Tick { place: scenario.place.clone(), times: all.join(", ") }
    })
}

#[cfg(test)]
mod tests {
    use super::{Scenario, clock};

    #[test]
    fn every_time_leaves_room_for_the_sums_of_a_run() {
        // Ticks of a nanosecond: half of the range are 4.6e9 s, all of it 9.2e9 s.
        let ticks = |start: &str, stop: &str, latency: &str| {
            let text = format!(
                "format = 1\nexperiment = {{ start = {start}, stop = {stop} }}\n[[units]]\nname = \"a\"\nfmu = \"x.fmu\"\n\
                 interval = 1e-9\n[[connections]]\nfrom = \"a.y\"\nto = \"a.u\"\nlatency = {latency}\n"
            );
            clock(&Scenario::parse(&text, "test.toml").expect("a scenario")).map(|(_, ticks)| ticks.stop)
        };
        assert_eq!(ticks("-4.6e9", "4.6e9", "4.6e9").expect("fits"), 4_600_000_000_000_000_000);
        // Ticks of 4.5 s fit, and their times don't: 9e18 s is 2e18 ticks of nine halves.
        let text = "format = 1\nexperiment = { stop = 9e18 }\n[[units]]\nname = \"a\"\nfmu = \"x.fmu\"\ninterval = 4.5\n";
        assert!(clock(&Scenario::parse(text, "test.toml").expect("a scenario")).is_err());
        for (start, stop, latency) in [("-4.7e9", "0", "0"), ("0", "4.7e9", "0"), ("0", "1", "4.7e9")] {
            let error = ticks(start, stop, latency).expect_err("too long").to_string();
            assert!(error.contains("have no common tick that fits 64 bits"), "{error}");
        }
    }
}
