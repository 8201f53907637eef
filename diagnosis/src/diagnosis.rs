//! What a diagnosis says: docs/diagnosis-json.md, field by field.

use crate::error::Notice;
pub use crate::gap::{Closing, Gap};
use crate::overlay::Overlaid;
use crate::planned::Planned;
use crate::provenance::Provenance;
use crate::text::{brief, with_digits_of};
use serde::Serialize;
use std::collections::BTreeMap;

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(Default))]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Nothing is missing that this data could show.
    #[cfg_attr(test, default)]
    None,
    /// Every effect found has one name.
    Named,
    /// An effect found has several names that the data can't tell apart.
    Ambiguous,
    /// Something is missing that no candidate gives.
    Unknown,
}

/// An effect that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// Best guess, `instance.variable`.
    pub name: String,
    /// All that the data can't tell from it, the best guess first.
    pub class: Vec<String>,
    /// Value of the parameter.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Probability that the truth is in the class, among all that were tried.
    pub probability: f64,
    /// The class with the probability of each member.
    pub members: Vec<Member>,
    /// What a person would call it.
    pub phrase: String,
    /// Unit of the value; empty for a number without one.
    pub unit: String,
    /// Value at which it is off in the nominal model.
    pub off: f64,
    /// It stands at an end of the range that is searched: it may lie beyond.
    pub at_end: bool,
    /// The data bound it from below only: the interval's upper end is the loosest that they could tell from none.
    pub unbounded: bool,
}

/// One of the names that an effect may have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Member {
    /// `instance.variable`.
    pub name: String,
    /// Probability among all that were tried.
    pub probability: f64,
}

impl Effect {
    /// A value of it as people write it, with digits that show the interval.
    pub fn written(&self, value: f64) -> String {
        with_digits_of(value, self.value, self.ci95)
    }
}

/// Where simulation and data disagree.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Where {
    /// `instance.variable`.
    pub signal: String,
    /// Its share of all disagreement.
    pub share: f64,
    /// First time, s.
    pub from: f64,
    /// Last time, s.
    pub to: f64,
    /// Where in the picture or the state space.
    pub region: String,
}

/// A residual that no candidate takes away.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Unknown {
    /// Where it shows.
    pub signal: String,
    /// Variables that it follows.
    pub depends_on: Vec<String>,
    /// Its form in words.
    pub shape: String,
    /// The listed effect that comes nearest, and why it is not that.
    pub nearest: String,
    /// Its smoothed course over the first run: times in s and values; empty where only its shape is known.
    pub trace: Vec<[f64; 2]>,
    /// The same for each run.
    pub traces: Vec<RunTrace>,
    /// Unit of these values.
    pub unit: String,
}

/// What has no name, over one run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunTrace {
    /// The run's file.
    pub run: String,
    /// Times in s and values.
    pub trace: Vec<[f64; 2]>,
}

impl Unknown {
    /// What the gap on rows that were left out says of it, where its course is all that is known.
    pub fn left_open(&self) -> Option<&'static str> {
        (!self.trace.is_empty()).then_some(
            "The course of what has no name is known where it was measured, and nothing predicts it on the rows left out: there the gap \
             closes by what the names explain, and stays open for the rest",
        )
    }
}

/// A term with its coefficient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Term {
    /// Parameter of the residual unit.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Unit of the value.
    #[serde(rename = "unit")]
    pub measure: String,
    /// In words.
    pub phrase: String,
}

/// A labelled correction: no explanation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correction {
    /// What it is, in words.
    pub label: String,
    /// Name of the unit in `amended.toml`.
    pub unit: String,
    /// Its terms, the most important first.
    pub terms: Vec<Term>,
    /// What it closes.
    pub gap: Closing,
    /// Effects that were named before and that it makes needless: the amended model goes without them.
    pub supersedes: Vec<String>,
    /// All parameters of the unit that differ from their start values.
    #[serde(skip)]
    pub parameters: Vec<(String, f64)>,
    /// What is left of torques of a usual size on runs left out, as gaps of effects are measured, N·m.
    #[serde(skip)]
    pub usual: f64,
    /// What is left on both links on runs left out: run, from, to (s), N·m.
    #[serde(skip)]
    pub left: Vec<(usize, f64, f64, [f64; 2])>,
}

impl Term {
    /// Its value in a few digits.
    pub fn short(&self) -> String {
        brief(self.value)
    }
}

/// What a lab should do next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextExperiment {
    /// In words.
    #[serde(rename = "do")]
    pub what: String,
    /// Whom it tells apart.
    pub separates: Vec<String>,
    /// The scenario file written beside, if the experiment is one.
    pub scenario: Option<String>,
    /// Groups that stay together even then.
    pub leaves_open: Vec<Vec<String>>,
    /// All experiments that were simulated, the best first.
    pub separation: Vec<Separation>,
    /// Loss below which two members count as not told apart, for the report.
    #[serde(skip)]
    pub told: f64,
    /// The best one as a picture, for the report.
    #[serde(skip)]
    pub planned: Option<Planned>,
}

/// How well an experiment would tell the members of a class apart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Separation {
    /// The experiment in a few words.
    pub experiment: String,
    /// Deviance that is expected to be lost by taking one member for another, for the pair that is hardest.
    pub loss: Option<f64>,
    /// That pair.
    pub pair: Vec<String>,
    /// Probability that the true member is expected to have afterwards.
    pub certainty: Option<f64>,
    /// Why it could not be simulated.
    pub problem: Option<String>,
}

/// `diagnosis.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(Default))]
pub struct Diagnosis {
    /// Where it comes from.
    pub provenance: Provenance,
    /// The answer in one word.
    pub verdict: Verdict,
    /// Effects in the order found.
    pub effects: Vec<Effect>,
    /// Where they show, largest share first.
    #[serde(rename = "where")]
    pub place: Vec<Where>,
    /// How the gap shrinks where it is largest.
    pub gap: Gap,
    /// The residual that has no name.
    pub unknown: Option<Unknown>,
    /// A labelled correction of that rest, which the amended scenario has in a residual unit.
    pub correction: Option<Correction>,
    /// What would tell the members of an open class apart.
    pub next_experiment: Option<NextExperiment>,
    /// Distance from off that this data would show, for each candidate it says anything about.
    pub minimum_detectable: BTreeMap<String, f64>,
    /// The gap of each cut.
    pub gaps: Vec<Gap>,
    /// The same by cross-validation: of our own rig, where runs were held out.
    pub cross_validation: Vec<Gap>,
    /// What ended with what it had, since time was up.
    pub ended_early: Vec<String>,
    /// What was found wrong with the data.
    pub notices: Vec<Notice>,
    /// The story, step by step, in words.
    pub story: Vec<String>,
    /// The amended scenario.
    #[serde(skip)]
    pub amended: String,
    /// Files that the amended scenario reads, by name.
    #[serde(skip)]
    pub attachments: Vec<(String, String)>,
    /// The next experiment's scenario.
    #[serde(skip)]
    pub experiment: Option<String>,
    /// Units of the model's variables.
    #[serde(skip)]
    pub units: BTreeMap<String, String>,
    /// Pictures of the residual for the report.
    #[serde(skip)]
    pub traces: Vec<Trace>,
    /// Measured, nominal and amended for the report.
    #[serde(skip)]
    pub channels: Vec<Overlaid>,
}

impl Diagnosis {
    /// Of what is missing that has no name: after a whole search, or as far as it came.
    pub fn nameless(&self) -> &'static str {
        match self.ended_early.is_empty() {
            true => "that no listed effect gives",
            false => "that has no name yet: time was up before the search came to an end",
        }
    }

    /// Whether the gap is judged on a part of a run, of which the search saw the rest: its name says from when to when.
    pub fn left_out_a_part(&self) -> bool {
        let whole = |name: &String| self.provenance.runs.iter().any(|used| used.run == *name);
        !self.gap.held_out_runs.iter().all(whole)
    }

    /// Whether the search was made once more for each part that the gap is judged on. Our own rig's way does, and has a cross-validation of
    /// the whole search beside it; the way of any unit judges the search that it made without the rows left out.
    pub fn repeats_the_search(&self) -> bool {
        !self.cross_validation.is_empty()
    }

    /// On what the gap was judged, as the terminal says it.
    pub fn judged_on(&self) -> String {
        let runs = self.gap.held_out_runs.join(", ");
        match self.gap.held_out_runs.as_slice() {
            [] => "by cross-validation".to_owned(),
            [_] if self.left_out_a_part() => {
                format!("on a part left out ({runs}), for which the search was repeated without it")
            }
            _ if self.left_out_a_part() => {
                format!("on parts left out ({runs}), for each of which the search was repeated without it")
            }
            _ => format!("on held-out runs ({runs}), for which the search was repeated without them"),
        }
    }

    /// Whether a diagnosis of other data would count this one (`--after`): it weighs the names that were found here.
    pub fn counts_later(&self) -> bool {
        let open = self.next_experiment.is_some() || self.verdict == Verdict::Unknown;
        open && !self.effects.is_empty()
    }
}

/// A residual over time, before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// What.
    pub title: String,
    /// Unit.
    pub unit: String,
    /// The link whose torque it is.
    pub link: usize,
    /// Time since the first run's begin (runs one after the other), nominal residual.
    pub before: Vec<(f64, f64)>,
    /// The same with the amended model.
    pub after: Vec<(f64, f64)>,
}

#[cfg(test)]
mod tests {
    use super::{Diagnosis, Gap};
    use crate::provenance::{Provenance, Used};

    fn judged(runs: &[&str], held_out: &[&str]) -> Diagnosis {
        let used = |run: &&str| Used { run: (*run).to_owned(), rows: std::collections::BTreeMap::new() };
        let provenance = Provenance { runs: runs.iter().map(used).collect(), ..Provenance::default() };
        let held_out_runs = held_out.iter().map(|run| (*run).to_owned()).collect();
        Diagnosis { provenance, gap: Gap { held_out_runs, ..Gap::default() }, ..Diagnosis::default() }
    }

    #[test]
    fn value_a_part_of_the_only_run_is_not_told_as_a_run() {
        let (whole, part) =
            (judged(&["a.csv", "b.csv"], &["b.csv"]), judged(&["a.csv"], &["a.csv from 7.0 to 10.0 s"]));
        assert!(whole.judged_on().starts_with("on held-out runs (b.csv)") && !whole.left_out_a_part());
        assert!(
            part.judged_on().starts_with("on a part left out (a.csv from 7.0 to 10.0 s)"),
            "{}",
            part.judged_on()
        );
        assert_eq!(judged(&["a.csv"], &[]).judged_on(), "by cross-validation");
    }

    #[test]
    fn value_no_gap_is_told_as_closed_by_more_than_all_of_it() {
        let told = |closed| Gap { closed: Some(closed), ..Gap::default() }.percent();
        assert_eq!([0.5, 1.0, 1.001].map(told), [Some(50.0), Some(100.0), Some(100.0)]);
    }

    #[test]
    fn law_a_gap_that_no_row_tells_of_is_written_as_none() {
        let untold = Gap { before: f64::NAN, after: f64::NAN, ..Gap::default() };
        let written = serde_json::to_value(&untold).expect("a gap is written");
        assert!(!untold.is_told() && written["before"].is_null() && written["after"].is_null(), "{written}");
        assert!(Gap::default().is_told(), "a gap of nothing is one");
    }
}
