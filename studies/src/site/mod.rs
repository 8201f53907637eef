//! The pages of a reproduction: `index.html` with every statement, figure and table, and a page for each study with live graphs.

mod lens;
mod study;

use crate::Error;
use crate::claim::{Claim, Kind, Outcome, Study, Tally};
use maud::html;
use report::{Cell, Figure, Filtered, Marked, Page, Provenance, Standing, Verdict};

pub use study::page;

/// The name of the index, for readers.
const TITLE: &str = "Camera Modelling for Visual Servo Control Applications, reproduced";

/// What a row is, in words that a reader can choose by.
fn kind(claim: &Claim) -> &'static str {
    match claim.kind {
        Kind::Claim => "statement",
        Kind::Part => "figure, table or part",
        Kind::Definition => "laid down by the paper",
        Kind::Measurement => "measurement of ours",
    }
}

/// `index.html`.
pub fn index(outcomes: &[(&Study, Outcome)], provenance: &Provenance) -> String {
    let mut page = Page::new(TITLE);
    let claims = || outcomes.iter().flat_map(|(_, outcome)| &outcome.claims);
    page.verdict(&verdict(&Tally::of(claims())));
    page.origin_line(provenance);
    page.heading("Every statement");
    page.text(
        "What fails comes first. A name leads to its study: the paper's caption, our figure, the tolerance and its reason.",
    );
    page.filtered(&statements(outcomes));
    page.heading("Every study, with its figures and tables");
    for (study, outcome) in outcomes {
        page.push(html! { details.study id=(study.id) {
            summary { (study.title) " " span.soft { (in_short(outcome)) } }
            p { a href=(address(study)) { "Its own page, with cursor, zoom and all reasons" } }
            @for note in &outcome.notes { p { (report::page::inline(note)) } }
            div.row { @for figure in &outcome.figures { (report::page::figure(&figure.svg, &figure.caption)) } }
            @for (title, table) in &outcome.tables {
                h3 { (report::page::inline(title)) }
                (report::page::table(table))
            }
        } });
    }
    page.provenance(provenance);
    page.scripted("site", "null".to_owned(), &[], STYLE);
    page.to_html()
}

const STYLE: &str = include_str!("../../assets/site.css");

/// Where a study's page lies, seen from the index.
fn address(study: &Study) -> String {
    format!("studies/{}.html", study.id)
}

/// `3 statements, 5 figures`.
fn in_short(outcome: &Outcome) -> String {
    let holding = outcome.claims.iter().filter(|claim| claim.holds).count();
    let many = |count: usize, one: &str, more: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        count => Some(format!("{count} {more}")),
    };
    let rows = format!("{holding} of {} rows hold", outcome.claims.len());
    let rest =
        [many(outcome.figures.len(), "figure", "figures"), many(outcome.tables.len(), "table", "tables")];
    std::iter::once(rows).chain(rest.into_iter().flatten()).collect::<Vec<_>>().join(", ")
}

fn verdict(tally: &Tally) -> Verdict {
    let count = |label: &str, value: usize| Figure::new(label, Some(value as f64), "");
    let whole = tally.holding == tally.claims && tally.parts_holding == tally.parts;
    Verdict {
        standing: if whole { Standing::Good } else { Standing::Plain },
        words: format!("{} of {} statements of the paper hold.", tally.holding, tally.claims),
        figures: vec![
            count("statements that do not", tally.claims - tally.holding),
            count("figures, tables and parts that do not", tally.parts - tally.parts_holding),
            count("laid down by the paper", tally.definitions),
            count("measurements of ours", tally.measurements),
        ],
        notes: vec!["What does not hold is shown as such, with the reason beside it.".to_owned()],
    }
}

fn statements(outcomes: &[(&Study, Outcome)]) -> Filtered {
    let mut rows: Vec<(&Study, &Claim)> = (outcomes.iter())
        .flat_map(|(study, outcome)| outcome.claims.iter().map(move |claim| (*study, claim)))
        .collect();
    // Stable: within a kind the order of the paper stays.
    rows.sort_by_key(|(_, claim)| (claim.holds, claim.kind));
    let row = |(study, claim): (&Study, &Claim)| Marked {
        id: claim.id.clone(),
        marks: vec![if claim.holds { "holds" } else { "does not hold" }.to_owned(), kind(claim).to_owned()],
        cells: vec![
            Cell::Link(claim.id.clone(), format!("{}#{}", address(study), claim.id)),
            claim.quantity.as_str().into(),
            claim.paper.as_str().into(),
            claim.ours.as_str().into(),
            holds(claim),
            claim.note.as_str().into(),
        ],
    };
    Filtered {
        what: "rows".to_owned(),
        head: ["id", "claim", "paper", "ours", "holds", "note"].map(str::to_owned).to_vec(),
        rows: rows.into_iter().map(row).collect(),
    }
}

/// Whether it holds, in words that fit what it is: "measured" says that a measurement is still the one expected.
fn holds(claim: &Claim) -> Cell {
    let words = match (claim.kind, claim.holds) {
        (Kind::Definition, true) => "taken over",
        (Kind::Measurement, true) => "measured",
        (_, true) => "holds",
        (Kind::Measurement, false) => "not as expected",
        (_, false) => "does not hold",
    };
    Cell::Holds(claim.holds, words.replace(' ', "\u{a0}"))
}

/// All pages: the name of each below the folder of results, and its text.
///
/// # Errors
/// A graph can't be drawn.
pub fn pages(
    outcomes: &[(&Study, Outcome)],
    provenance: &Provenance,
) -> Result<Vec<(String, String)>, Error> {
    let mut pages = vec![("index.html".to_owned(), index(outcomes, provenance))];
    for (place, (study, outcome)) in outcomes.iter().enumerate() {
        let before = place.checked_sub(1).map(|place| outcomes[place].0);
        let next = outcomes.get(place + 1).map(|(next, _)| *next);
        pages.push((address(study), page(study, outcome, (before, next), provenance)?));
    }
    Ok(pages)
}

#[cfg(test)]
mod tests {
    use super::pages;
    use crate::claim::{Claim, Outcome};
    use crate::registry::STUDIES;
    use report::{Axis, Graph, Line, Provenance};

    #[test]
    fn law_what_fails_comes_first_and_every_row_has_its_page() {
        let of = |id: &str| STUDIES.iter().find(|study| study.id == id).expect("is registered");
        let claim = |id: &str, holds| Claim::new([id, "what < is", "yes"], "ours", "because", holds, "note");
        let mut first = Outcome { claims: vec![claim("C17", true)], ..Outcome::default() };
        let line = Line::solid("q", vec![(0.0, 0.0), (1.0, 1.0)]);
        let graph = Graph::new("t", Axis::fitted("x"), Axis::fitted("y")).with(line);
        first.graph(graph, "Figure 12: our caption.").expect("drawn");
        let second = Outcome { claims: vec![claim("C35", false)], ..Outcome::default() };
        let outcomes = [(of("figure-12"), first), (of("figure-18"), second)];
        let made = pages(&outcomes, &Provenance::default()).expect("made");
        let names: Vec<&str> = made.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["index.html", "studies/figure-12.html", "studies/figure-18.html"]);
        let index = &made[0].1;
        let at = |text: &str| index.find(text).unwrap_or_else(|| panic!("{text} is in the index"));
        assert!(
            at("studies/figure-18.html#C35") < at("studies/figure-12.html#C17"),
            "what fails comes first"
        );
        assert!(index.contains("our caption") && index.contains("<svg"), "every figure is in the index");
        let page = &made[1].1;
        assert!(
            page.contains("Error in visual state estimation with no distortions."),
            "the paper's caption"
        );
        assert!(
            page.contains("id=\"C17\"")
                && page.contains("href=\"#C17\"")
                && page.contains("href=\"#figure-12\"")
        );
        assert!(page.contains("data-graph=\"0\"") && page.contains("../index.html"));
    }
}
