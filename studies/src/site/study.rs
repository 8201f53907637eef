//! The page of one study: the paper's caption beside our figure, what to look for, and each statement with its reasons.

use super::{STYLE, holds, kind, lens};
use crate::claim::{Claim, Outcome, Study};
use crate::{Error, paper};
use maud::{Markup, html};
use report::page::inline;
use report::{Figure, Page, Provenance, Standing, Verdict};

/// The page.
///
/// # Errors
/// A graph can't be drawn.
pub fn page(
    study: &Study,
    outcome: &Outcome,
    beside: (Option<&Study>, Option<&Study>),
    provenance: &Provenance,
) -> Result<String, Error> {
    let mut page = Page::new(study.title);
    page.scripted("site", "null".to_owned(), &[], STYLE);
    page.push(way(beside, "other studies"));
    page.verdict(&verdict(outcome));
    page.origin_line(provenance);
    for note in &outcome.notes {
        page.text(note);
    }
    if study.id == lens::STUDY {
        lens::sliders(&mut page)?;
    }
    if !outcome.figures.is_empty() {
        page.heading("Figures");
        figures(&mut page, outcome)?;
    }
    page.heading("Statements");
    page.push(html! { @for claim in &outcome.claims { (statement(claim, outcome)) } });
    if !outcome.tables.is_empty() {
        page.heading("Tables");
        for (title, table) in &outcome.tables {
            page.push(html! { h3 { (inline(title)) } });
            page.table(table);
        }
    }
    page.provenance(provenance);
    page.push(way(beside, "other studies, again"));
    Ok(page.to_html())
}

/// To the index and to the neighbours.
fn way((before, next): (Option<&Study>, Option<&Study>), label: &str) -> Markup {
    let to = |study: &Study| format!("{}.html", study.id);
    html! { nav.way aria-label=(label) {
        a href="../index.html" { "All statements" }
        @if let Some(study) = before { a href=(to(study)) rel="prev" { "← " (study.title) } }
        @if let Some(study) = next { a href=(to(study)) rel="next" { (study.title) " →" } }
    } }
}

fn verdict(outcome: &Outcome) -> Verdict {
    let fail: Vec<&str> =
        outcome.claims.iter().filter(|claim| !claim.holds).map(|claim| claim.id.as_str()).collect();
    let all = outcome.claims.len();
    let words = match fail.as_slice() {
        [] if all == 1 => "Its statement holds.".to_owned(),
        [] => format!("All {all} rows hold."),
        [one] => format!("{one} does not hold; {} of {all} rows do.", all - 1),
        more => format!("{} do not hold; {} of {all} rows do.", more.join(", "), all - more.len()),
    };
    let standing = if fail.is_empty() { Standing::Good } else { Standing::Plain };
    Verdict { standing, words, figures: Vec::<Figure>::new(), notes: Vec::new() }
}

/// Pictures of one figure of the paper together, below its caption.
fn figures(page: &mut Page, outcome: &Outcome) -> Result<(), Error> {
    let mut at = 0;
    while let Some(first) = outcome.figures.get(at) {
        let printed = paper::beside(&first.caption);
        let goes_on = |figure: &&crate::claim::Figure| paper::beside(&figure.caption).is_none();
        let more = outcome.figures[at + 1..].iter().take_while(goes_on).count();
        let group = &outcome.figures[at..=at + more];
        let words = printed.map(|printed| {
            html! { section.printed id=(format!("figure-{}", printed.number)) {
                p { b { "The paper's Figure " (printed.number) ": " } (printed.caption) }
                p { b { "What to look for: " } (printed.look) }
                p { "It shows " (links(printed.claims, outcome)) "." }
            } }
        });
        let mut parts = Vec::new();
        for figure in group {
            parts.push(match &figure.graph {
                Some(graph) => page.place(graph, &figure.caption)?,
                None => report::page::figure(&figure.svg, &figure.caption),
            });
        }
        // A single figure leaves room beside it.
        page.push(html! { div.of-paper.single[parts.len() == 1] {
            @if let Some(words) = words { (words) }
            div.row { @for part in &parts { (part) } }
        } });
        at += 1 + more;
    }
    Ok(())
}

/// Links to statements of this page.
fn links(claims: &[&str], outcome: &Outcome) -> Markup {
    let here: Vec<&str> = (claims.iter().copied())
        .filter(|claim| outcome.claims.iter().any(|known| known.id == *claim))
        .collect();
    html! { @for (place, claim) in here.iter().enumerate() {
        @if place > 0 { ", " }
        a href=(format!("#{claim}")) { (claim) }
    } }
}

/// One statement, with its reasons and the figures that show it.
fn statement(claim: &Claim, outcome: &Outcome) -> Markup {
    let there = |number: u32| {
        outcome
            .figures
            .iter()
            .any(|figure| paper::beside(&figure.caption).is_some_and(|at| at.number == number))
    };
    let shown: Vec<u32> =
        paper::showing(&claim.id).map(|figure| figure.number).filter(|number| there(*number)).collect();
    html! { article.statement id=(claim.id) {
        h3 { (claim.id) ": " (inline(&claim.quantity)) " " span.soft { (kind(claim)) } }
        dl {
            div { dt { "paper" } dd { (inline(&claim.paper)) } }
            div { dt { "ours" } dd { (inline(&claim.ours)) } }
            div { dt { "holds" } dd { (report::page::words(&holds(claim))) } }
            div { dt { "tolerance and its reason" } dd { (inline(&claim.tolerance)) } }
            @if !claim.note.is_empty() { div { dt { "note" } dd { (inline(&claim.note)) } } }
            @if !shown.is_empty() { div { dt { "shown in" } dd {
                @for (place, number) in shown.iter().enumerate() {
                    @if place > 0 { ", " }
                    a href=(format!("#figure-{number}")) { "Figure " (number) }
                }
            } } }
        }
    } }
}
