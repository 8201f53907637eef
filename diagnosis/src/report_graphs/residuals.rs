//! What is left, as graphs: of the channel in which what was found shows most, and of the one whose residual remembers most; over
//! time, over its own past, over the states and the inputs, before and after.

use super::{BINS, COLUMNS, LAGS, OVER, amended, labelled, refused};
use crate::diagnosis::{Diagnosis, Trace};
use crate::error::Error;
use crate::overlay::{Bin, Dependence, Overlaid, at, autocorrelation, binned};
use crate::statistics::levels::WITHIN;
use report::thin::thin;
use report::{Axis, Graph, Line, Page, Style};

/// What the lines say, and what they don't: a camera's pixels and an encoder's counts leave a memory that no effect explains.
const LINES: &str = "The residual is what was measured less what the model gives. Between the dotted lines lies 95 % of what white noise \
                     gives. A course over time, or a dependence on a state or an input, is what a lacking effect leaves.";
const MEMORY: &str = "Memory alone does not say that the model lacks something: the error of a sensor may have a memory, too, as that of \
                      pixels, of counts, of a filter. How large it is beside noise, the table above says.";

/// The residual: over time, over its own past, over the states and the inputs.
pub fn residuals(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    let traces: Vec<(Graph, String)> = diagnosis.traces.iter().filter_map(trace).collect();
    let (found, worst) = (found(diagnosis), worst(&diagnosis.channels));
    let of_found = found.map_or_else(Vec::new, graphs);
    let other = worst.filter(|worst| found.is_none_or(|found| found.signal != worst.signal));
    let of_other = other.map_or_else(Vec::new, graphs);
    if traces.is_empty() && of_found.is_empty() && of_other.is_empty() {
        return Ok(());
    }
    page.heading("What is left");
    page.text(LINES);
    for (channel, graphs) in [(None, traces), (found, of_found), (other, of_other)] {
        if graphs.is_empty() {
            continue;
        }
        if let Some(channel) = channel {
            page.text(&told(channel, diagnosis, worst));
        }
        page.graphs(&graphs).map_err(refused)?;
    }
    Ok(())
}

/// Which channel is drawn, and why.
fn told(channel: &Overlaid, diagnosis: &Diagnosis, worst: Option<&Overlaid>) -> String {
    let signal = &channel.signal;
    let share = diagnosis.place.iter().find(|place| place.signal == *signal).map(|place| place.share);
    let why = match share {
        Some(share) => {
            format!("{signal} has {:.0} % of the disagreement between log and nominal model.", 100.0 * share)
        }
        None => format!("Of all channels compared, the residual of {signal} has the strongest memory."),
    };
    let remembers = worst.is_some_and(|worst| worst.signal == *signal) && beyond(channel);
    if remembers { format!("{why} {MEMORY}") } else { why }
}

/// All graphs of a channel.
fn graphs(channel: &Overlaid) -> Vec<(Graph, String)> {
    over_time(channel).into_iter().chain(of_past(channel)).chain(over_variables(channel)).collect()
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

/// The channel in which what was found shows most.
fn found(diagnosis: &Diagnosis) -> Option<&Overlaid> {
    let of = |signal: &String| diagnosis.channels.iter().find(|channel| channel.signal == *signal);
    let any = !diagnosis.effects.is_empty() || diagnosis.unknown.is_some();
    diagnosis.place.iter().filter(|_| any).find_map(|place| of(&place.signal))
}

/// The channel whose residual remembers most.
fn worst(channels: &[Overlaid]) -> Option<&Overlaid> {
    channels.iter().max_by(|a, b| memory(a).total_cmp(&memory(b)))
}

/// The correlation with the row before.
fn memory(channel: &Overlaid) -> f64 {
    autocorrelation(&channel.residual, 1).first().map_or(0.0, |(_, at)| at.abs())
}

/// Within this of 0 lie 95 % of the correlations of so many values of white noise.
fn chance_of_memory(values: usize) -> f64 {
    WITHIN / (values as f64).sqrt()
}

/// Whether a residual remembers more than white noise does.
fn beyond(channel: &Overlaid) -> bool {
    memory(channel) > chance_of_memory(channel.residual.len())
}

/// What the nominal model leaves.
fn left_by_nominal(channel: &Overlaid) -> Vec<(f64, f64)> {
    let less = |(time, value): &(f64, f64)| Some((*time, at(&channel.measured, *time)? - value));
    channel.nominal.iter().filter_map(less).collect()
}

fn over_time(channel: &Overlaid) -> Option<(Graph, String)> {
    let nominal = left_by_nominal(channel);
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

/// Adds the lines between which noise lies.
fn with_noise(graph: Graph, above: Vec<(f64, f64)>, below: Vec<(f64, f64)>) -> Graph {
    let line = |label: &str, points| Line { label: label.to_owned(), style: Style::Dotted, points };
    graph.with(line("noise, above", above)).with(line("noise, below", below))
}

fn of_past(channel: &Overlaid) -> Option<(Graph, String)> {
    let title = format!("Residual of {}: autocorrelation", channel.signal);
    let mut graph = Graph::new(title, Axis::fitted("rows before"), Axis::over("correlation", -1.0, 1.0));
    let past = autocorrelation(&channel.residual, LAGS);
    let last = past.last()?.0;
    if amended(channel) {
        graph = graph
            .with(Line::dashed("nominal", autocorrelation(&left_by_nominal(channel), LAGS)))
            .with(Line::solid("amended", past));
    } else {
        graph = graph.with(Line::solid("nominal", past));
    }
    let chance = chance_of_memory(channel.residual.len());
    let [above, below] = [chance, -chance].map(|side| vec![(1.0, side), (last, side)]);
    let graph = with_noise(graph, above, below);
    (last > 1.0).then_some((graph, String::new()))
}

/// Within this of 0 lie 95 % of the means of so many rows, if the residuals are noise.
fn chance(pairs: &[(f64, f64)], rows: usize) -> f64 {
    let finite = || pairs.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
    let square = finite().map(|(_, residual)| residual * residual).sum::<f64>() / finite().count() as f64;
    WITHIN * (square / rows as f64).sqrt()
}

/// A residual over a state or an input, before and after.
struct Followed<'a> {
    over: &'a Dependence,
    nominal: Vec<Bin>,
    amended: Vec<Bin>,
}

impl<'a> Followed<'a> {
    fn of(over: &'a Dependence) -> Self {
        Self { over, nominal: binned(&over.nominal, BINS), amended: binned(&over.pairs, BINS) }
    }

    /// How much the residual follows: what was found shows in the nominal one, what is left in the amended one.
    fn size(&self) -> f64 {
        let square =
            |bins: &[Bin]| bins.iter().map(|bin| bin.mean * bin.mean).sum::<f64>() / bins.len().max(1) as f64;
        square(&self.nominal) + square(&self.amended)
    }
}

/// The residual over the states and inputs that it follows most, in their own order.
fn over_variables(channel: &Overlaid) -> Vec<(Graph, String)> {
    let mut all: Vec<(usize, Followed<'_>)> = channel.over.iter().map(Followed::of).enumerate().collect();
    all.retain(|(_, followed)| followed.amended.len() > 2);
    all.sort_by(|a, b| b.1.size().total_cmp(&a.1.size()));
    all.truncate(OVER);
    all.sort_by_key(|(place, _)| *place);
    all.iter().map(|(_, followed)| (over_variable(channel, followed), String::new())).collect()
}

fn over_variable(channel: &Overlaid, followed: &Followed<'_>) -> Graph {
    let over = followed.over;
    let means = |bins: &[Bin]| bins.iter().map(|bin| (bin.at, bin.mean)).collect::<Vec<_>>();
    let noise = |side: f64| -> Vec<(f64, f64)> {
        followed.amended.iter().map(|bin| (bin.at, side * chance(&over.pairs, bin.rows))).collect()
    };
    let title = format!("Residual of {} over {}", channel.signal, over.name);
    let y = labelled("mean residual", &channel.unit);
    let graph = Graph::new(title, Axis::fitted(labelled(&over.name, &over.unit)), Axis::fitted(y));
    let graph = match amended(channel) {
        true => graph
            .with(Line::dashed("nominal", means(&followed.nominal)))
            .with(Line::solid("amended", means(&followed.amended))),
        false => graph.with(Line::solid("nominal", means(&followed.amended))),
    };
    with_noise(graph, noise(1.0), noise(-1.0))
}

#[cfg(test)]
mod tests {
    use super::{BINS, WITHIN, binned, chance, over_variables, residuals};
    use crate::diagnosis::{Diagnosis, Effect, Where};
    use crate::overlay::{Dependence, Overlaid};

    /// Residuals of 2 and -2, one after the other, or twice each in turn.
    fn channel(signal: &str, rows: u32, each: u32) -> Overlaid {
        let value = |row: u32| if (row / each).is_multiple_of(2) { 2.0 } else { -2.0 };
        let course =
            |of: &dyn Fn(u32) -> f64| (0..rows).map(|row| (f64::from(row), of(row))).collect::<Vec<_>>();
        let pairs = course(&value);
        let over = vec![Dependence {
            name: "box.u".into(),
            unit: "V".into(),
            pairs: pairs.clone(),
            nominal: pairs.clone(),
        }];
        Overlaid {
            run: "run-01".into(),
            left_out: false,
            signal: signal.into(),
            unit: String::new(),
            drawn: true,
            measured: course(&|row| 1.0 + value(row)),
            nominal: course(&|_| 1.0),
            amended: course(&|_| 1.0),
            residual: pairs,
            over,
        }
    }

    #[test]
    fn value_means_of_noise_stay_within_what_is_drawn() {
        // Residuals of 2 and -2: their root mean square is 2; a bin of 25 of them scatters by 2/5.
        let pairs: Vec<(f64, f64)> =
            (0..100).map(|row| (f64::from(row), if row % 2 == 0 { 2.0 } else { -2.0 })).collect();
        let within = 1.959_963_984_540_054; // scipy.stats.norm.ppf(0.975)
        assert!((chance(&pairs, 25) - within * 0.4).abs() < 1e-12);
        assert!((chance(&pairs, 1) - within * 2.0).abs() < 1e-12, "a bin of one scatters as each of them");
        let lost = [&pairs[..], &[(1.0, f64::NAN)]].concat();
        assert!((chance(&lost, 25) - within * 0.4).abs() < 1e-12, "what isn't there doesn't count");
    }

    #[test]
    fn value_the_lines_are_those_of_each_bins_own_rows() {
        // 601 rows: a log of six seconds at a hundred rows a second
        let drawn = over_variables(&channel("box.y", 601, 1));
        let [(graph, _)] = drawn.as_slice() else { panic!("{}", drawn.len()) };
        let above = &graph.lines[1].points;
        let bins = binned(&channel("box.y", 601, 1).over[0].pairs, BINS);
        assert_eq!(above.len(), bins.len());
        for (line, bin) in above.iter().zip(&bins) {
            assert!((line.1 - WITHIN * 2.0 / (bin.rows as f64).sqrt()).abs() < 1e-9, "{line:?} {bin:?}");
        }
        assert_eq!(graph.lines[2].points[0].1, -above[0].1);
    }

    #[test]
    fn law_what_is_said_is_about_the_channel_that_is_drawn() {
        let place = |signal: &str, share: f64| Where {
            signal: signal.into(),
            share,
            from: 0.0,
            to: 1.0,
            region: String::new(),
        };
        let effect = Effect {
            name: "box.C".into(),
            class: vec!["box.C".into()],
            value: 2.0,
            ci95: [1.0, 3.0],
            probability: 0.9,
            members: Vec::new(),
            phrase: "heat capacity".into(),
            unit: "J/K".into(),
            off: 1.0,
            at_end: false,
            unbounded: false,
        };
        // + + - - hardly remembers the row before
        let quiet = channel("box.quiet", 60, 2);
        let slow = Overlaid { left_out: true, ..channel("box.slow", 60, 6) };
        let diagnosis = Diagnosis {
            effects: vec![effect],
            place: vec![place("box.quiet", 0.75)],
            channels: vec![slow, quiet],
            ..Diagnosis::default()
        };
        let mut page = report::Page::new("x");
        residuals(&diagnosis, &mut page).expect("drawn");
        let html = page.to_html();
        let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} is on the page"));
        // first where what was found shows, then what remembers most, each with its words
        assert!(at("box.quiet has 75 %") < at("Residual of box.quiet over box.u"));
        assert!(
            at("Residual of box.quiet over box.u") < at("the residual of box.slow has the strongest memory")
        );
        assert!(
            at("the residual of box.slow has the strongest memory")
                < at("Residual of box.slow: autocorrelation")
        );
        assert_eq!(html.matches("Memory alone does not say").count(), 1);
        assert!(!html.contains("no memory"));
    }
}
