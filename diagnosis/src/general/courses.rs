//! Measured, nominal and amended of a run that was left out, from the windows that judge the gap.

use super::windows::Window;
use crate::dynamics::Engine;
use crate::overlay::{Dependence, Overlaid, at};

/// The channels in this order, of the last run: before and after are the nominal and the amended model's windows.
pub fn courses(engine: &Engine, order: &[usize], before: &[Window], after: &[Window]) -> Vec<Overlaid> {
    let Some(run) = after.iter().map(|window| window.run).max() else { return Vec::new() };
    let grid = &engine.grids[run];
    let of = |channel: &usize| {
        let output = &engine.machine.channels[*channel];
        let own = grid.samples.iter().filter(|sample| sample.channel == *channel);
        let mut measured: Vec<(f64, f64)> = own.map(|sample| (sample.time, sample.value)).collect();
        measured.dedup_by(|later, earlier| later.0 == earlier.0);
        let model = |windows: &[Window]| -> Vec<(f64, f64)> {
            let less = |(time, residual): (f64, f64)| Some((time, at(&measured, time)? - residual));
            residuals(windows, run, *channel).into_iter().filter_map(less).collect()
        };
        Overlaid {
            run: grid.name.clone(),
            left_out: true,
            signal: output.name.clone(),
            unit: output.unit.clone(),
            drawn: true,
            nominal: model(before),
            amended: model(after),
            residual: residuals(after, run, *channel),
            over: dependences(engine, (before, after), *channel),
            measured,
        }
    };
    order.iter().map(of).filter(|channel| channel.amended.len() > 1).collect()
}

/// Residuals of a channel in a run, in order of time.
fn residuals(windows: &[Window], run: usize, channel: usize) -> Vec<(f64, f64)> {
    let own = windows.iter().filter(|window| window.run == run).flat_map(|window| &window.points);
    let own = own.filter(|point| point.channel == channel).map(|point| (point.time, point.residual));
    let mut points: Vec<(f64, f64)> = own.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|later, earlier| later.0 == earlier.0);
    points
}

/// Both residuals beside each state and each fed input, over all windows.
fn dependences(
    engine: &Engine,
    (nominal, amended): (&[Window], &[Window]),
    channel: usize,
) -> Vec<Dependence> {
    let machine = &engine.machine;
    let n = machine.order();
    let unit = |place: Option<usize>| place.map(|place| machine.channels[place].unit.clone());
    let states = machine.states.iter().enumerate().map(|(place, state)| {
        let value = |window: &Window, row: usize, _: f64| window.states[row * n + place];
        Dependence {
            name: state.name.clone(),
            unit: unit(state.channel).unwrap_or_default(),
            pairs: pairs(amended, channel, &value),
            nominal: pairs(nominal, channel, &value),
        }
    });
    let inputs = machine.inputs.iter().enumerate().map(|(place, input)| {
        let value = |window: &Window, _: usize, time: f64| engine.grids[window.run].inputs[place].value(time);
        Dependence {
            name: input.name.clone(),
            unit: input.unit.clone(),
            pairs: pairs(amended, channel, &value),
            nominal: pairs(nominal, channel, &value),
        }
    });
    states.chain(inputs).collect()
}

/// A channel's residuals, each beside a value of its window at its row and time.
fn pairs(windows: &[Window], channel: usize, value: &dyn Fn(&Window, usize, f64) -> f64) -> Vec<(f64, f64)> {
    let of = |window: &Window| -> Vec<(f64, f64)> {
        let own = window.points.iter().filter(|point| point.channel == channel);
        own.map(|point| (value(window, point.row, point.time), point.residual)).collect()
    };
    windows.iter().flat_map(of).collect()
}
