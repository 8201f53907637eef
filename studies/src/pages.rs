//! `index.html`: one row a claim, then each study with its figures and tables.

use crate::claim::{Outcome, Study};
use maud::html;
use report::{Cell, Page, Table};

/// The whole page.
pub fn index(outcomes: &[(&Study, Outcome)]) -> String {
    let mut page = Page::new("Camera Modelling for Visual Servo Control Applications, reproduced");
    let claims = || outcomes.iter().flat_map(|(_, outcome)| &outcome.claims);
    let holding = claims().filter(|claim| claim.holds).count();
    page.text(&format!(
        "{holding} of {} statements hold. Those that don't are shown as such, with the reason beside them.",
        claims().count()
    ));
    page.heading("Every claim");
    page.push(
        html! { ul { @for (study, _) in outcomes { li { a href={"#" (study.id)} { (study.title) } } } } },
    );
    let head = ["id", "claim", "paper", "ours", "holds", "tolerance and its reason", "note"];
    let rows = claims().map(|claim| {
        vec![
            claim.id.as_str().into(),
            claim.quantity.as_str().into(),
            claim.paper.as_str().into(),
            claim.ours.as_str().into(),
            Cell::Holds(
                claim.holds,
                if claim.holds { "holds" } else { "does\u{a0}not\u{a0}hold" }.to_owned(),
            ),
            claim.tolerance.as_str().into(),
            claim.note.as_str().into(),
        ]
    });
    page.table(&Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() });
    for (study, outcome) in outcomes {
        page.push(html! { a id=(study.id) {} });
        page.heading(study.title);
        for note in &outcome.notes {
            page.text(note);
        }
        let figures: Vec<_> =
            outcome.figures.iter().map(|figure| (figure.svg.clone(), figure.caption.clone())).collect();
        page.figures(&figures);
        for (title, table) in &outcome.tables {
            page.push(html! { h3 { (title) } });
            page.table(table);
        }
    }
    page.to_html()
}
