//! The graphs of `report.html`: measured, nominal and amended over each other, what is left over time, over its own past and
//! over the states.

use crate::diagnosis::{Diagnosis, Trace};
use crate::error::Error;
use crate::overlay::{Channel, autocorrelation, binned};
use report::{Axis, Graph, Line, Page};

/// Channels that are shown, at most: with more nobody finds the one that matters.
const CHANNELS: usize = 10;
/// Rows before that the autocorrelation looks at, and bins of the states.
const LAGS: usize = 40;
const BINS: usize = 24;

fn refused(error: report::Error) -> Error {
    Error::Model(error.to_string())
}

/// The first picture any engineer asks for.
pub fn overlays(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    let shown: Vec<&Channel> = diagnosis
        .channels
        .iter()
        .filter(|channel| !channel.signal.contains(".area"))
        .take(CHANNELS)
        .collect();
    let Some(first) = shown.first() else { return Ok(()) };
    page.heading("Measured, nominal and amended");
    page.text(&format!(
        "{}, the last run with rows of a channel. Where the motion is compared, a window of it starts at the state that fits it best, \
         since a balanced arm would leave its log otherwise; nominal and amended are what the units give from there.",
        first.run
    ));
    let graphs: Vec<(Graph, String)> =
        shown.iter().map(|channel| (overlay(channel), String::new())).collect();
    page.graphs(&graphs).map_err(refused)?;
    Ok(())
}

fn overlay(channel: &Channel) -> Graph {
    let title = format!("{} of {}", channel.signal, channel.run);
    let y = format!("{} in {}", channel.signal, channel.unit);
    Graph::new(title, Axis::fitted("time in s"), Axis::fitted(y))
        .with(Line::dots("measured", channel.measured.clone()))
        .with(Line::dashed("nominal", channel.nominal.clone()))
        .with(Line::solid("amended", channel.amended.clone()))
}

/// What is left: over time, over its own past, over the states.
pub fn rests(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    let mut graphs: Vec<(Graph, String)> = diagnosis.traces.iter().filter_map(trace).collect();
    if let Some(channel) = worst(&diagnosis.channels) {
        graphs.extend(of_past(channel));
        graphs.extend(of_states(channel));
    }
    if graphs.is_empty() {
        return Ok(());
    }
    page.heading("What is left");
    page.text(
        "A model that lacks nothing leaves noise: no course over time, no memory, no dependence on a state. Dashed lines at the \
         autocorrelation: 95 % of what noise gives.",
    );
    page.graphs(&graphs).map_err(refused)?;
    Ok(())
}

/// Runs one after the other, before and after.
fn trace(trace: &Trace) -> Option<(Graph, String)> {
    if trace.before.is_empty() {
        return None;
    }
    let y = format!("rest in {}", trace.unit);
    let graph =
        Graph::new(&trace.title, Axis::fitted("time in s, runs one after the other"), Axis::fitted(y))
            .with(Line::dots("nominal", trace.before.clone()))
            .with(Line::dots("amended", trace.after.clone()));
    Some((graph, String::new()))
}

/// The channel whose rest remembers most.
fn worst(channels: &[Channel]) -> Option<&Channel> {
    let memory =
        |channel: &Channel| autocorrelation(&channel.rest, 1).first().map_or(0.0, |(_, at)| at.abs());
    channels.iter().max_by(|a, b| memory(a).total_cmp(&memory(b)))
}

fn of_past(channel: &Channel) -> Option<(Graph, String)> {
    let past = autocorrelation(&channel.rest, LAGS);
    let last = past.last()?.0;
    let chance = 1.96 / (channel.rest.len() as f64).sqrt();
    let title = format!("Rest of {}: autocorrelation", channel.signal);
    let graph = Graph::new(title, Axis::fitted("rows before"), Axis::over("correlation", -1.0, 1.0))
        .with(Line::solid("amended", past))
        .with(Line::dashed("noise, above", vec![(1.0, chance), (last, chance)]))
        .with(Line::dashed("noise, below", vec![(1.0, -chance), (last, -chance)]));
    (last > 1.0).then_some((graph, String::new()))
}

fn of_states(channel: &Channel) -> Vec<(Graph, String)> {
    let names = [("q1", "rad"), ("q2", "rad"), ("dq1", "rad/s"), ("dq2", "rad/s")];
    let of = |(index, (name, unit)): (usize, (&str, &str))| {
        let pairs = channel.over_states.iter().map(|(state, rest)| (state[index], *rest)).collect();
        let means = binned(pairs, BINS);
        let title = format!("Rest of {} over {name}", channel.signal);
        let y = format!("mean rest in {}", channel.unit);
        let graph = Graph::new(title, Axis::fitted(format!("{name} in {unit}")), Axis::fitted(y))
            .with(Line::solid("amended", means.clone()));
        (means.len() > 2).then_some((graph, String::new()))
    };
    names.into_iter().enumerate().filter_map(of).collect()
}
