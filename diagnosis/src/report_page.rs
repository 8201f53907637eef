//! `report.html`: the story with its numbers and pictures.

use crate::diagnosis::{Correction, Diagnosis, Effect, Gap, Member, NextExperiment, Unknown, Verdict};
use crate::error::Error;
use crate::planned;
use crate::report_graphs;
use crate::text::{alike, brief};
use report::{Cell, Figure, Page, Standing, Table};

/// The page.
///
/// # Errors
/// A graph can't be drawn.
pub fn html(diagnosis: &Diagnosis) -> Result<String, Error> {
    let mut page = Page::new(title(diagnosis));
    show_verdict(diagnosis, &mut page);
    show_missing(diagnosis, &mut page)?;
    show_next(diagnosis, &mut page)?;
    report_graphs::overlays(diagnosis, &mut page)?;
    page.heading("Step by step");
    for line in &diagnosis.story {
        page.text(line);
    }
    show_gap(diagnosis, &mut page)?;
    show_detectable(diagnosis, &mut page);
    if !diagnosis.notices.is_empty() {
        page.heading("The data");
        for notice in &diagnosis.notices {
            page.text(&notice.to_string());
        }
    }
    Ok(page.to_html())
}

/// Two pages side by side are told apart by their data sets.
fn title(diagnosis: &Diagnosis) -> String {
    match diagnosis.provenance.data.as_str() {
        "" => "Diagnosis".to_owned(),
        data => format!("Diagnosis of {data}"),
    }
}

/// The answer, whether it ended early, and where it comes from.
fn show_verdict(diagnosis: &Diagnosis, page: &mut Page) {
    page.verdict(&verdict(diagnosis));
    if !diagnosis.ended_early.is_empty() {
        let ended = diagnosis.ended_early.join("; ");
        page.text(&format!(
            "Time was up (--budget gives it more): it ended with what was there. Cut short were {ended}."
        ));
    }
    page.facts(&diagnosis.provenance.lines());
}

/// Effects, and what has no name.
fn show_missing(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    if !diagnosis.effects.is_empty() {
        page.heading("What is missing");
        page.table(&effects(diagnosis));
    }
    let Some(unknown) = &diagnosis.unknown else { return Ok(()) };
    page.heading("What has no name");
    page.text(&format!("{}: {}. {}.", sentence(&unknown.signal), unknown.shape, sentence(&unknown.nearest)));
    report_graphs::unlisted(unknown, page)?;
    if let Some(correction) = &diagnosis.correction {
        page.text(&corrected(correction));
        page.table(&terms(correction));
    }
    Ok(())
}

/// The next experiment, and what to do now.
fn show_next(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    if let Some(next) = &diagnosis.next_experiment {
        page.heading("Next experiment");
        page.text(&describe_experiment(next));
        if let Some(planned) = &next.planned {
            planned::show(planned, page)?;
        }
        if !next.separation.is_empty() {
            page.text(&format!(
                "Each experiment that was simulated with the members of the class as the truth, the best first: the surer it tells \
                 them apart, and of those as sure the simpler to carry out. Loss: the deviance that a diagnosis of its data would lose by taking \
                 one member for another; below {} they count as not told apart.",
                brief(next.told)
            ));
            page.table(&experiments(next));
        }
    }
    page.heading("What to do now");
    for line in now(diagnosis) {
        page.text(&line);
    }
    Ok(())
}

/// How far simulation and log are apart, before and after.
fn show_gap(diagnosis: &Diagnosis, page: &mut Page) -> Result<(), Error> {
    page.heading("How the gap shrinks");
    page.text(&describe_judgement(diagnosis));
    page.table(&gaps(&diagnosis.gaps));
    if let Some(open) = what_stays_open(diagnosis) {
        page.text(&format!("{open}."));
    }
    if !diagnosis.gap.held_out_runs.is_empty() && diagnosis.repeats_the_search() {
        page.text(
            "By cross-validation (values fitted without each run in turn, effects chosen with all of them):",
        );
        page.table(&gaps(&diagnosis.cross_validation));
    }
    report_graphs::residuals(diagnosis, page)?;
    if !diagnosis.place.is_empty() {
        page.heading("Where they disagree");
        page.table(&places(diagnosis));
    }
    if diagnosis.unknown.is_some() && !diagnosis.effects.is_empty() {
        page.text(
            "Beside a residual without a name a name is worth less: its probability is the share that it alone explains of that and of what \
             nothing explains, and its interval covers where it would stand if another name went.",
        );
    }
    Ok(())
}

/// What these data would have shown.
fn show_detectable(diagnosis: &Diagnosis, page: &mut Page) {
    page.heading("What this data would show");
    if diagnosis.minimum_detectable.is_empty() {
        page.text("Beside a residual without a name nobody knows what would have been found.");
        return;
    }
    page.text(
        "A candidate that is not named above is not excluded up to this distance from its neutral value. At it, 39 of 40 such data sets would name \
         the effect; at two thirds of it about half.",
    );
    page.table(&Table {
        head: vec!["candidate".into(), "smallest that would be found".into(), "unit".into()],
        rows: (diagnosis.minimum_detectable.iter())
            .map(|(name, size)| vec![name.clone().into(), Cell::Number(brief(*size)), unit(diagnosis, name)])
            .collect(),
    });
}

/// What stays open on the rows left out, in words.
fn what_stays_open(diagnosis: &Diagnosis) -> Option<&'static str> {
    diagnosis.unknown.as_ref().and_then(Unknown::left_open)
}

/// The answer, in large letters.
fn verdict(diagnosis: &Diagnosis) -> report::Verdict {
    let value = |effect: &Effect| Figure {
        // a gain of 1.00054 is no 1.001; a count has no interval
        written: (effect.ci95[0] < effect.ci95[1]).then(|| effect.written(effect.value)),
        ..Figure::new(&effect.name, Some(effect.value), &effect.unit)
    };
    let mut figures: Vec<Figure> = diagnosis.effects.iter().map(value).collect();
    // of an unlisted input alone no gap closes, whatever was found of it
    let alone = diagnosis.effects.is_empty() && what_stays_open(diagnosis).is_some();
    if let Some(closed) = diagnosis.gap.percent().filter(|_| diagnosis.verdict != Verdict::None && !alone) {
        let percent = (10.0 * closed).round() / 10.0;
        figures.push(Figure::new("gap closed", Some(percent), "%"));
    }
    let standing = match diagnosis.verdict {
        Verdict::None | Verdict::Named => Standing::Good,
        Verdict::Ambiguous | Verdict::Unknown => Standing::Plain,
    };
    report::Verdict { standing, words: summary(diagnosis), figures, notes: Vec::new() }
}

/// What comes next, with the commands for it.
fn now(diagnosis: &Diagnosis) -> Vec<String> {
    let mut lines = Vec::new();
    if diagnosis.verdict != Verdict::None {
        lines.push(
            "Beside this page lies `amended.toml`, the model with what was found. In that folder `acroscope run amended.toml --out replay` \
             runs it with the inputs of a run, and `acroscope view replay` shows it."
                .to_owned(),
        );
    }
    let scenario = diagnosis.next_experiment.as_ref().and_then(|next| next.scenario.as_deref());
    if let Some(scenario) = scenario {
        lines.push(format!(
            "`acroscope run {scenario} --out rehearsal` shows what the next experiment would do."
        ));
    }
    if diagnosis.counts_later() {
        lines.push(
            "After the next recording `acroscope diagnose NEW-DATA --after .` lets this diagnosis count beside it.".to_owned(),
        );
    }
    if lines.is_empty() {
        lines.push(
            "Nothing: the nominal model explains these data. The last table says what these data could not have shown."
                .to_owned(),
        );
    }
    lines
}

fn summary(diagnosis: &Diagnosis) -> String {
    let names: Vec<String> =
        diagnosis.effects.iter().map(|effect| format!("{} ({})", effect.phrase, effect.name)).collect();
    match diagnosis.verdict {
        Verdict::None => "Nothing is missing from the nominal model that this data could show.".into(),
        Verdict::Named => format!("The nominal model lacks: {}.", names.join(", ")),
        Verdict::Ambiguous => {
            format!(
                "The nominal model lacks: {}; at least one of them goes by several names that this data can't tell apart.",
                names.join(", ")
            )
        }
        Verdict::Unknown if names.is_empty() => format!("Something is missing {}.", diagnosis.nameless()),
        Verdict::Unknown => format!(
            "Something is missing {}; {} may stand for a part of it, or be missing beside it.",
            diagnosis.nameless(),
            names.join(", ")
        ),
    }
}

/// Unit of a variable of the model.
fn unit(diagnosis: &Diagnosis, name: &str) -> Cell {
    diagnosis.units.get(name).cloned().unwrap_or_default().into()
}

/// With a capital, unless it begins with the name of a variable.
fn sentence(words: &str) -> String {
    let first = words.split(' ').next().unwrap_or_default();
    let mut letters = words.chars();
    match letters.next().filter(|_| !first.contains('.')) {
        Some(letter) => letter.to_uppercase().chain(letters).collect(),
        None => words.to_owned(),
    }
}

fn effects(diagnosis: &Diagnosis) -> Table {
    let alike = diagnosis.effects.iter().any(|effect| effect.members.len() > 1);
    let names = ["effect", "name", "value", "95 %", "neutral", "unit", "probability", "can't be told from"];
    // A column without a word says nothing.
    let head = if alike { &names[..] } else { &names[..7] };
    let rows = diagnosis.effects.iter().map(|effect| {
        let number = |value: f64| Cell::Number(effect.written(value));
        let [low, high] = effect.ci95;
        let mut row: Vec<Cell> = vec![
            match effect.at_end {
                true => {
                    format!("{} (at the end of what can be tried: it may lie beyond)", effect.phrase).into()
                }
                false if effect.unbounded => {
                    format!("{} (these data give no upper bound)", effect.phrase).into()
                }
                false => effect.phrase.clone().into(),
            },
            effect.name.clone().into(),
            number(effect.value),
            Cell::Number(format!("{} ... {}", effect.written(low), effect.written(high))),
            number(effect.off),
            effect.unit.clone().into(),
            Cell::Number(format!("{:.3}", effect.probability)),
        ];
        row.extend(alike.then(|| others(effect).into()));
        row
    });
    Table { head: head.iter().map(|name| (*name).to_owned()).collect(), rows: rows.collect() }
}

/// The rest of the class, each with its probability.
fn others(effect: &Effect) -> String {
    let told = |member: &Member| format!("{} ({:.2})", member.name, member.probability);
    effect.members.iter().skip(1).map(told).collect::<Vec<_>>().join(", ")
}

fn corrected(correction: &Correction) -> String {
    let gap = &correction.gap;
    format!(
        "The amended model carries {} (unit {}): on runs left out the lacking torque goes from {} to {} N·m, where \
         noise alone gives {}. Beyond the angles and rates that the data covered its terms stay what they are there.",
        correction.label,
        correction.unit,
        brief(gap.before),
        brief(gap.after),
        brief(gap.floor)
    )
}

fn terms(correction: &Correction) -> Table {
    let rows = correction.terms.iter().map(|term| {
        vec![
            term.name.clone().into(),
            Cell::Number(format!("{:.5}", term.value)),
            Cell::Number(format!("{:.5} ... {:.5}", term.ci95[0], term.ci95[1])),
            term.measure.clone().into(),
            term.phrase.clone().into(),
        ]
    });
    Table {
        head: ["parameter", "value", "95 %", "unit", "term"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

fn describe_experiment(next: &NextExperiment) -> String {
    let mut text = format!("{}.", sentence(next.what.trim_end_matches('.')));
    if !next.separates.is_empty() {
        text += &format!(" It tells apart: {}.", next.separates.join(", "));
    }
    for group in &next.leaves_open {
        text += &format!(" It does not tell apart: {}.", group.join(", "));
    }
    if let Some(file) = &next.scenario {
        text += &format!(" Its scenario is {file}.");
    }
    text
}

/// Every experiment of the catalogue that this machine can do, simulated.
fn experiments(next: &NextExperiment) -> Table {
    let head = ["experiment", "loss of the hardest pair", "that pair", "probability of the truth afterwards"];
    let rows = next.separation.iter().map(|line| {
        let number = |value: Option<f64>, digits: usize| {
            Cell::Number(value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}")))
        };
        let pair = line.problem.clone().unwrap_or_else(|| line.pair.join(", "));
        vec![line.experiment.clone().into(), number(line.loss, 1), pair.into(), number(line.certainty, 3)]
    });
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}

/// On which runs the gap is judged, and what the model knew of them.
fn describe_judgement(diagnosis: &Diagnosis) -> String {
    let gap = &diagnosis.gap;
    match gap.held_out_runs.as_slice() {
        [] => format!(
            "By cross-validation over {}: values fitted without each in turn, effects chosen with all of them.",
            gap.cross_validated.join(", ")
        ),
        runs if !diagnosis.repeats_the_search() => format!(
            "On rows that were left out ({}): the search was made without them, and what it named was judged there; nothing is fitted to \
             them but where each window begins. Noise alone is what the data set states, or else what was fitted, as far as neighbouring rows \
             scatter.",
            runs.join(", ")
        ),
        runs => format!(
            "On held-out runs ({}): for each part of them the search was repeated without it, and what it then named was judged there. \
             Noise alone is what the data set states, or the scatter of neighbouring rows; no model was fitted for it.",
            runs.join(", ")
        ),
    }
}

fn gaps(gaps: &[Gap]) -> Table {
    let head = ["signal", "unit", "before", "after", "noise alone", "closed"];
    let rows = gaps.iter().map(|gap| {
        let open = if gap.is_told() { "no gap" } else { "not followed" };
        let closed = gap.percent().map_or(open.to_owned(), |percent| format!("{percent:.1} %"));
        let sizes = [gap.before, gap.after, gap.floor];
        let told = alike(sizes);
        let [before, after, floor] = std::array::from_fn(|place| {
            let number = told[place].clone();
            if sizes[place].is_nan() { Cell::from("–".to_owned()) } else { Cell::Number(number) }
        });
        vec![gap.signal.clone().into(), gap.unit.clone().into(), before, after, floor, Cell::Number(closed)]
    });
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}

fn places(diagnosis: &Diagnosis) -> Table {
    let rows = diagnosis.place.iter().map(|place| {
        vec![
            place.signal.clone().into(),
            Cell::Number(format!("{:.0} %", 100.0 * place.share)),
            Cell::Number(format!("{:.1} ... {:.1} s", place.from, place.to)),
            place.region.clone().into(),
        ]
    });
    Table { head: ["signal", "share", "when", "where"].map(str::to_owned).to_vec(), rows: rows.collect() }
}

#[cfg(test)]
mod tests {
    use super::describe_experiment;
    use crate::diagnosis::NextExperiment;

    #[test]
    fn value_an_experiment_is_told_in_sentences_that_do_not_contradict_each_other() {
        let pair = || vec!["box.C".to_owned(), "box.k".to_owned()];
        let next = |separates, leaves_open| NextExperiment {
            what: "drive box.u".into(),
            separates,
            scenario: None,
            leaves_open,
            separation: Vec::new(),
            told: 9.0,
            planned: None,
        };
        let told = |separates, leaves_open| describe_experiment(&next(separates, leaves_open));
        assert_eq!(told(pair(), vec![]), "Drive box.u. It tells apart: box.C, box.k.");
        assert_eq!(told(vec![], vec![pair()]), "Drive box.u. It does not tell apart: box.C, box.k.");
    }
}
