//! `index.html`: one row a claim by what it is, then each study with its rows, figures and tables.

use crate::claim::{Claim, Kind, Outcome, Study, Tally};
use maud::html;
use report::{Cell, Page, Provenance, Table};

/// The groups of rows, in order, each with its heading.
const GROUPS: [(Kind, &str); 4] = [
    (Kind::Claim, "Every statement of the paper"),
    (Kind::Part, "Figures, tables and parts of statements"),
    (Kind::Definition, "What the paper lays down"),
    (Kind::Measurement, "Measurements of our own: what the paper asks or leaves open"),
];

/// The whole page.
pub fn index(outcomes: &[(&Study, Outcome)], provenance: &Provenance) -> String {
    let mut page = Page::new("Camera Modelling for Visual Servo Control Applications, reproduced");
    let claims = || outcomes.iter().flat_map(|(_, outcome)| &outcome.claims);
    page.text(&format!(
        "{}. What doesn't hold is shown as such, with the reason beside it.",
        Tally::of(claims())
    ));
    page.provenance(provenance);
    page.push(
        html! { ul { @for (study, _) in outcomes { li { a href={"#" (study.id)} { (study.title) } } } } },
    );
    for (kind, heading) in GROUPS {
        let rows: Vec<&Claim> = claims().filter(|claim| claim.kind == kind).collect();
        if !rows.is_empty() {
            page.heading(heading);
            page.table(&table(&rows));
        }
    }
    for (study, outcome) in outcomes {
        page.push(html! { a id=(study.id) {} });
        page.heading(study.title);
        for note in &outcome.notes {
            page.text(note);
        }
        let rows: Vec<&Claim> = outcome.claims.iter().collect();
        page.table(&table(&rows));
        let figures: Vec<_> =
            outcome.figures.iter().map(|figure| (figure.svg.clone(), figure.caption.clone())).collect();
        page.figures(&figures);
        for (title, table) in &outcome.tables {
            page.push(html! { h3 { (report::page::inline(title)) } });
            page.table(table);
        }
    }
    page.to_html()
}

/// A row a claim.
fn table(claims: &[&Claim]) -> Table {
    let head = ["id", "claim", "paper", "ours", "holds", "tolerance and its reason", "note"];
    let rows = claims.iter().map(|claim| {
        vec![
            claim.id.as_str().into(),
            claim.quantity.as_str().into(),
            claim.paper.as_str().into(),
            claim.ours.as_str().into(),
            verdict(claim),
            claim.tolerance.as_str().into(),
            claim.note.as_str().into(),
        ]
    });
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}

/// Whether it holds, in words that fit what it is: "as measured" says that a measurement is still the one expected.
fn verdict(claim: &Claim) -> Cell {
    let words = match (claim.kind, claim.holds) {
        (Kind::Definition, true) => "taken over",
        (Kind::Measurement, true) => "measured",
        (_, true) => "holds",
        (Kind::Measurement, false) => "not as expected",
        (_, false) => "does not hold",
    };
    Cell::Holds(claim.holds, words.replace(' ', "\u{a0}"))
}
