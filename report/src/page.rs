//! One self-contained HTML page: headings, text, tables, drawn graphs and pictures, in the order they are added.

use crate::Error;
use crate::graph::Graph;
use crate::live::Live;
use base64::Engine as _;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::{Deserialize, Serialize};

/// A page that is filled from top to bottom.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    body: Vec<Markup>,
    live: Live,
}

/// A table of text.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Heads of the columns.
    pub head: Vec<String>,
    /// Rows, each as long as the head.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number, set flush right.
    Number(String),
    /// A statement that holds or does not.
    Holds(bool, String),
    /// Words that lead to an address.
    Link(String, String),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

const STYLE: &str = include_str!("../assets/page.css");
/// Columns from which on a table is no table on a phone.
const CARDS: usize = 5;

impl Page {
    /// An empty page.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), body: Vec::new(), live: Live::default() }
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) -> &mut Self {
        self.push(html! { h2 { (inline(text)) } })
    }

    /// A paragraph. What stands between backticks, here and in captions and cells, is set as code.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.push(html! { p { (inline(text)) } })
    }

    /// A drawn graph with a caption.
    pub fn figure(&mut self, svg: &str, caption: &str) -> &mut Self {
        self.push(figure(svg, caption))
    }

    /// Several drawn graphs side by side where the window is wide enough: (SVG, caption).
    pub fn figures(&mut self, figures: &[(String, String)]) -> &mut Self {
        self.push(html! { div.row { @for (svg, caption) in figures { (figure(svg, caption)) } } })
    }

    /// Graphs with captions, side by side where the window is wide enough, for cursor and zoom.
    ///
    /// # Errors
    /// One of them can't be drawn.
    pub fn graphs(&mut self, graphs: &[(Graph, String)]) -> Result<&mut Self, Error> {
        let places = self.places(graphs)?;
        Ok(self.push(places))
    }

    /// The same for a place that the caller chooses: what is answered is still to be pushed.
    ///
    /// # Errors
    /// One of them can't be drawn.
    pub fn places(&mut self, graphs: &[(Graph, String)]) -> Result<Markup, Error> {
        let mut places = Vec::with_capacity(graphs.len());
        for (graph, caption) in graphs {
            places.push(self.live.add(graph, caption)?);
        }
        Ok(html! { div.row { @for place in &places { (place) } } })
    }

    /// One graph for a place that the caller chooses.
    ///
    /// # Errors
    /// It can't be drawn.
    pub fn place(&mut self, graph: &Graph, caption: &str) -> Result<Markup, Error> {
        self.live.add(graph, caption)
    }

    /// Takes a column of values for a script of the page's own, which gets it back as `acro.column(number)`.
    ///
    /// # Errors
    /// It can't be written.
    pub fn column(&mut self, values: &[f64]) -> Result<usize, Error> {
        self.live.values(values)
    }

    /// Adds scripts of the page's own, which run when those for graphs are there and find `json` as `acro.data(id)`.
    pub fn scripted(
        &mut self,
        id: &'static str,
        json: String,
        scripts: &'static [&'static str],
        style: &'static str,
    ) -> &mut Self {
        self.live.own(id, json, scripts, style);
        self
    }

    /// Places side by side where the window is wide enough.
    pub fn side_by_side(&mut self, places: &[Markup]) -> &mut Self {
        self.push(html! { div.row { @for place in places { (place) } } })
    }

    /// A PNG picture with a caption and an alternative text.
    pub fn picture(&mut self, png: &[u8], caption: &str) -> &mut Self {
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        let source = format!("data:image/png;base64,{data}");
        self.push(html! { figure { img src=(source) alt=(caption.replace('`', "")); figcaption { (inline(caption)) } } })
    }

    /// A table.
    pub fn table(&mut self, of: &Table) -> &mut Self {
        self.push(table(of))
    }

    /// Names in columns.
    pub fn names<'a>(&mut self, names: impl IntoIterator<Item = &'a str>) -> &mut Self {
        self.push(html! { ul.names { @for name in names { li { code { (name) } } } } })
    }

    /// Anything else.
    pub fn push(&mut self, markup: Markup) -> &mut Self {
        self.body.push(markup);
        self
    }

    /// The whole page.
    pub fn to_html(&self) -> String {
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    // Otherwise a browser asks the server for one, and complains.
                    link rel="icon" href="data:,";
                    style { (PreEscaped(STYLE)) }
                    @if !self.live.is_empty() { (self.live.styles()) }
                }
                body {
                    main { h1 { (self.title) } @for part in &self.body { (part) } }
                    @if !self.live.is_empty() { (self.live.scripts()) }
                }
            }
        }
        .into_string()
    }
}

/// A table for a place that the caller chooses.
pub fn table(table: &Table) -> Markup {
    // On a phone a row of many cells stands as lines: moved sideways, it would be cut in the middle of a number.
    let cards = table.head.len() >= CARDS;
    let head = |place: usize| table.head.get(place).filter(|_| cards).map(String::as_str);
    html! {
        // A keyboard can scroll what has the focus.
        div.scroll.cards[cards] tabindex="0" { table {
            thead { tr { @for name in &table.head { @if name.is_empty() { td {} } @else { th { (name) } } } } }
            tbody { @for row in &table.rows { tr {
                @for (place, cell) in row.iter().enumerate() { (cell_markup(cell, head(place))) }
            } } }
        } }
    }
}

/// A drawn graph with its caption for a place that the caller chooses.
pub fn figure(svg: &str, caption: &str) -> Markup {
    html! { figure.still tabindex="0" {
        (PreEscaped(named(svg, caption)))
        @if !caption.is_empty() { figcaption { (inline(caption)) } }
    } }
}

/// A drawing with its caption as a name, for those who can't see it.
pub(crate) fn named(svg: &str, caption: &str) -> String {
    match caption {
        "" => svg.to_owned(),
        _ if svg.split('>').next().is_some_and(|tag| tag.contains("aria-label")) => svg.to_owned(),
        words => {
            let words = html! { (words.replace('`', "")) }.into_string();
            svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{words}\" "), 1)
        }
    }
}

/// A cell, with the head of its column for pages that show it beside the cell.
pub(crate) fn cell_markup(cell: &Cell, label: Option<&str>) -> Markup {
    let class = matches!(cell, Cell::Number(_)).then_some("number");
    // What is empty has no space in it either, so that a style can leave it out.
    html! { td class=[class] data-label=[label] { (words(cell)) } }
}

/// The words of a cell outside a table.
pub fn words(cell: &Cell) -> Markup {
    match cell {
        Cell::Text(text) | Cell::Number(text) => html! { (inline(text)) },
        Cell::Holds(true, text) => html! { span.yes { "✓ " (inline(text)) } },
        Cell::Holds(false, text) => html! { span.no { "✗ " (inline(text)) } },
        Cell::Link(text, to) => html! { a href=(to) { (text) } },
    }
}

/// Text in which pairs of backticks enclose code; one without a partner stays as it is.
pub fn inline(text: &str) -> Markup {
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return html! { (text) };
    }
    html! {
        @for (index, part) in parts.iter().enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Cell, Page, Table};

    #[test]
    fn law_text_is_escaped() {
        let mut page = Page::new("a < b");
        page.text("<script>").table(&Table { head: vec!["&".into()], rows: vec![vec![Cell::from("\"<\"")]] });
        let html = page.to_html();
        assert!(
            html.contains("a &lt; b") && html.contains("&lt;script&gt;") && html.contains("<th>&amp;</th>")
        );
        assert!(!html.contains("<script>"));
    }

    #[test]
    fn law_the_cells_of_a_wide_table_say_their_column() {
        let of = |columns: usize| {
            let names = || (0..columns).map(|column| format!("h{column}"));
            let row = names().map(|name| Cell::Number(format!("{name} = 1")));
            super::table(&Table { head: names().collect(), rows: vec![row.collect()] }).into_string()
        };
        assert!(of(6).contains("scroll cards") && of(6).contains("data-label=\"h5\">h5 = 1"));
        assert!(!of(3).contains("cards") && !of(3).contains("data-label"), "three columns fit");
    }

    #[test]
    fn law_backticks_become_code() {
        let mut page = Page::new("x");
        let cells = vec![Cell::from("set `a<b`"), Cell::Holds(false, "`c`".into()), Cell::from("a ` alone")];
        page.text("run `cargo xtask pack` or `x`")
            .figure("<svg/>", "set `damped`")
            .table(&Table { head: vec![], rows: vec![cells] });
        let html = page.to_html();
        let code = |text: &str| html.contains(&format!("<code>{text}</code>"));
        assert!(code("cargo xtask pack") && code("x") && code("damped") && code("a&lt;b") && code("c"));
        assert_eq!(html.matches('`').count(), 1, "only the one without a partner is left");
    }
}
