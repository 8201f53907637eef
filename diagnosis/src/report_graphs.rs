//! The graphs of `report.html`: measured, nominal and amended over each other, the residual over time, over its own past, over
//! the states and the inputs.

use crate::diagnosis::{Diagnosis, RunTrace, Trace, Unknown};
use crate::error::Error;
use crate::overlay::{Channel, Dependence, at, autocorrelation, binned};
use crate::statistics::levels::WITHIN;
use report::thin::thin;
use report::{Axis, Graph, Line, Page};

/// Channels that are shown, at most: with more nobody finds the one that matters.
const CHANNELS: usize = 10;
/// Rows before that the autocorrelation looks at, and bins of a state or an input.
const LAGS: usize = 40;
const BINS: usize = 24;
/// Columns of a picture, of each of which a course keeps its first, least, greatest and last value: the page stays small.
const COLUMNS: usize = 900;
/// States and inputs that the residual is shown over, at most: those that it follows most.
const OVER: usize = 6;

/// The windows know no residual unit: without this, "amended" would seem to say that the correction is of no use.
const UNCORRECTED: &str =
    " The labelled correction is not in these curves, the named effects alone are; `amended.toml` has both.";

fn refused(error: report::Error) -> Error {
    Error::Model(error.to_string())
}

/// The course of an unlisted input, where it is known: of the runs in which it does most.
pub fn unlisted(unknown: &Unknown, page: &mut Page) -> Result<(), Error> {
    let mut told: Vec<&RunTrace> = unknown.traces.iter().filter(|run| run.trace.len() > 1).collect();
    let square = |run: &RunTrace| run.trace.iter().map(|[_, value]| value * value).sum::<f64>();
    told.sort_by(|a, b| square(b).total_cmp(&square(a)));
    told.truncate(OVER);
    // in the order of the runs again
    told.sort_by_key(|run| unknown.traces.iter().position(|known| known.run == run.run));
    let graph = |run: &&RunTrace| {
        let points: Vec<(f64, f64)> = run.trace.iter().map(|[time, value]| (*time, *value)).collect();
        let axis = Axis::fitted(labelled("unlisted input", &unknown.unit));
        let line = Line::solid("most likely course", thin(&points, COLUMNS));
        let title = format!("What acts on {}, {}", unknown.signal, run.run);
        (Graph::new(title, Axis::fitted("time in s"), axis).with(line), String::new())
    };
    let graphs: Vec<(Graph, String)> = told.iter().map(graph).collect();
    if !graphs.is_empty() {
        page.graphs(&graphs).map_err(refused)?;
    }
    Ok(())
}

/// The first picture any engineer asks for.
pub fn overlays(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    let shown: Vec<&Channel> =
        diagnosis.channels.iter().filter(|channel| channel.drawn).take(CHANNELS).collect();
    let Some(first) = shown.first() else { return Ok(()) };
    page.heading("Measured, nominal and amended");
    page.text(&format!(
        "{}{}, the last run with rows of a channel. Where the motion is compared, a window of it starts at the state that fits it best, \
         since a small error of the start would hide what the model lacks; nominal and amended are what the model gives from there.{}",
        first.run,
        if first.left_out { ", to which nothing was fitted" } else { "" },
        if diagnosis.correction.is_some() { UNCORRECTED } else { "" },
    ));
    let graphs: Vec<(Graph, String)> =
        shown.iter().map(|channel| (overlay(channel), String::new())).collect();
    page.graphs(&graphs).map_err(refused)?;
    Ok(())
}

fn overlay(channel: &Channel) -> Graph {
    let title = format!("{} of {}", channel.signal, channel.run);
    let y = labelled(&channel.signal, &channel.unit);
    let graph = Graph::new(title, Axis::fitted("time in s"), Axis::fitted(y))
        .with(Line::dots("measured", thin(&channel.measured, COLUMNS)))
        .with(Line::dashed("nominal", thin(&channel.nominal, COLUMNS)));
    match amended(channel) {
        true => graph.with(Line::solid("amended", thin(&channel.amended, COLUMNS))),
        false => graph,
    }
}

/// Whether anything was amended: two equal lines over each other look like one that is wrong.
fn amended(channel: &Channel) -> bool {
    channel.amended != channel.nominal
}

/// What an axis shows, with its unit if it has one.
fn labelled(what: &str, unit: &str) -> String {
    if unit.is_empty() { what.to_owned() } else { format!("{what} in {unit}") }
}

/// The residual: over time, over its own past, over the states and the inputs.
pub fn residuals(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    let mut graphs: Vec<(Graph, String)> = diagnosis.traces.iter().filter_map(trace).collect();
    if let Some(channel) = worst(&diagnosis.channels) {
        graphs.extend(over_time(channel));
        graphs.extend(of_past(channel));
        graphs.extend(over_variables(channel));
    }
    if graphs.is_empty() {
        return Ok(());
    }
    page.heading("What is left");
    page.text(
        "The residual is what was measured less what the model gives. A model that lacks nothing leaves noise: no course over time, \
         no memory, no dependence on a state or an input. Between the dashed lines lies 95 % of what noise gives.",
    );
    page.graphs(&graphs).map_err(refused)?;
    Ok(())
}

/// Runs one after the other, before and after.
fn trace(trace: &Trace) -> Option<(Graph, String)> {
    if trace.before.is_empty() {
        return None;
    }
    let y = labelled("residual", &trace.unit);
    let graph =
        Graph::new(&trace.title, Axis::fitted("time in s, runs one after the other"), Axis::fitted(y))
            .with(Line::dots("nominal", thin(&trace.before, COLUMNS)));
    let graph = match trace.after == trace.before {
        true => graph,
        false => graph.with(Line::dots("amended", thin(&trace.after, COLUMNS))),
    };
    Some((graph, String::new()))
}

/// The channel whose residual remembers most.
fn worst(channels: &[Channel]) -> Option<&Channel> {
    let memory =
        |channel: &Channel| autocorrelation(&channel.residual, 1).first().map_or(0.0, |(_, at)| at.abs());
    channels.iter().max_by(|a, b| memory(a).total_cmp(&memory(b)))
}

fn over_time(channel: &Channel) -> Option<(Graph, String)> {
    let less = |(time, value): &(f64, f64)| Some((*time, at(&channel.measured, *time)? - value));
    let nominal: Vec<(f64, f64)> = channel.nominal.iter().filter_map(less).collect();
    let title = format!("Residual of {}, {}", channel.signal, channel.run);
    let y = labelled("residual", &channel.unit);
    let graph = Graph::new(title, Axis::fitted("time in s"), Axis::fitted(y))
        .with(Line::dots("nominal", thin(&nominal, COLUMNS)));
    let graph = match amended(channel) {
        true => graph.with(Line::dots("amended", thin(&channel.residual, COLUMNS))),
        false => graph,
    };
    (nominal.len() > 1).then_some((graph, String::new()))
}

/// The model whose residual a graph shows.
fn model(channel: &Channel) -> &'static str {
    if amended(channel) { "amended" } else { "nominal" }
}

fn of_past(channel: &Channel) -> Option<(Graph, String)> {
    let past = autocorrelation(&channel.residual, LAGS);
    let last = past.last()?.0;
    let chance = WITHIN / (channel.residual.len() as f64).sqrt();
    let title = format!("Residual of {}: autocorrelation", channel.signal);
    let graph = Graph::new(title, Axis::fitted("rows before"), Axis::over("correlation", -1.0, 1.0))
        .with(Line::solid(model(channel), past))
        .with(Line::dashed("noise, above", vec![(1.0, chance), (last, chance)]))
        .with(Line::dashed("noise, below", vec![(1.0, -chance), (last, -chance)]));
    (last > 1.0).then_some((graph, String::new()))
}

/// Within this of 0 lie 95 % of the means of so many bins, if the residuals are noise.
fn chance(pairs: &[(f64, f64)], bins: usize) -> f64 {
    let square = pairs.iter().map(|(_, residual)| residual * residual).sum::<f64>() / pairs.len() as f64;
    let each = (pairs.len() as f64 / bins as f64).max(1.0);
    WITHIN * (square / each).sqrt()
}

/// The residual over the states and inputs that it follows most, in their own order.
fn over_variables(channel: &Channel) -> Vec<(Graph, String)> {
    let mean = |over: &Dependence| -> Vec<(f64, f64)> { binned(over.pairs.clone(), BINS) };
    let size = |(_, means): &(usize, Vec<(f64, f64)>)| -> f64 {
        means.iter().map(|(_, residual)| residual * residual).sum::<f64>() / means.len() as f64
    };
    let means = channel.over.iter().map(mean).enumerate().filter(|(_, means)| means.len() > 2);
    let mut means: Vec<(usize, Vec<(f64, f64)>)> = means.collect();
    means.sort_by(|a, b| size(b).total_cmp(&size(a)));
    means.truncate(OVER);
    means.sort_by_key(|(place, _)| *place);
    let of = |(place, means): (usize, Vec<(f64, f64)>)| {
        let over = &channel.over[place];
        let title = format!("Residual of {} over {}", channel.signal, over.name);
        let y = labelled("mean residual", &channel.unit);
        let ends = (means[0].0, means[means.len() - 1].0);
        let chance = chance(&over.pairs, means.len());
        let graph = Graph::new(title, Axis::fitted(labelled(&over.name, &over.unit)), Axis::fitted(y))
            .with(Line::solid(model(channel), means))
            .with(Line::dashed("noise, above", vec![(ends.0, chance), (ends.1, chance)]))
            .with(Line::dashed("noise, below", vec![(ends.0, -chance), (ends.1, -chance)]));
        (graph, String::new())
    };
    means.into_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::{chance, overlays};
    use crate::diagnosis::Diagnosis;
    use crate::overlay::Channel;

    #[test]
    fn every_channel_that_its_rig_lets_draw_is_drawn_whatever_its_name() {
        let course = vec![(0.0, 1.0), (1.0, 2.0)];
        let channel = |signal: &str, drawn: bool| Channel {
            run: "run-01".into(),
            left_out: false,
            signal: signal.into(),
            unit: String::new(),
            drawn,
            measured: course.clone(),
            nominal: course.clone(),
            amended: course.clone(),
            residual: Vec::new(),
            over: Vec::new(),
        };
        let channels = vec![channel("valve.area", true), channel("camera.extent", false)];
        let mut page = report::Page::new("x");
        overlays(&Diagnosis { channels, ..Diagnosis::default() }, &mut page).expect("drawn");
        let html = page.to_html();
        assert!(html.contains("valve.area of run-01") && !html.contains("camera.extent"));
    }

    #[test]
    fn value_means_of_noise_stay_within_what_is_drawn() {
        // Residuals of 2 and -2: their root mean square is 2; a bin of 25 of them scatters by 2/5.
        let pairs: Vec<(f64, f64)> =
            (0..100).map(|row| (f64::from(row), if row % 2 == 0 { 2.0 } else { -2.0 })).collect();
        let within = 1.959_963_984_540_054; // scipy.stats.norm.ppf(0.975)
        assert!((chance(&pairs, 4) - within * 0.4).abs() < 1e-12);
        assert!((chance(&pairs, 100) - within * 2.0).abs() < 1e-12, "a bin of one scatters as each of them");
    }
}
