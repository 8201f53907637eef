//! A table that a reader can narrow: by words, and by what its rows are marked with. Without scripts all rows are there.

use crate::Page;
use crate::page::{Cell, cell_markup};
use maud::html;

/// A table with marks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Filtered {
    /// What its rows are, for readers and for the counter: `claims`.
    pub what: String,
    /// Heads of the columns.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Marked>,
}

/// A row and its marks.
#[derive(Debug, Clone, PartialEq)]
pub struct Marked {
    /// Its name in addresses of this page; empty: none.
    pub id: String,
    /// Marks, one of each kind, in the same order in all rows: `does not hold`, `statement`.
    pub marks: Vec<String>,
    /// Cells, as many as the head.
    pub cells: Vec<Cell>,
}

const SCRIPT: &str = include_str!("../assets/filter.js");
const STYLE: &str = include_str!("../assets/filter.css");

impl Page {
    /// A table with a field for words and a button for each mark. On a narrow page each row is a block.
    pub fn filtered(&mut self, table: &Filtered) -> &mut Self {
        self.scripted("filter", "null".to_owned(), &[SCRIPT], STYLE);
        self.push(html! {
            div.filtered data-what=(table.what) {
                div.scroll tabindex="0" role="group" aria-label=(table.what) { table {
                    thead { tr { @for name in &table.head { th { (name) } } } }
                    tbody { @for row in &table.rows {
                        tr id=[(!row.id.is_empty()).then_some(&row.id)] data-marks=(row.marks.join("\u{1f}")) {
                            @for (cell, name) in row.cells.iter().zip(&table.head) { (cell_markup(cell, Some(name))) }
                        }
                    } }
                } }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Filtered, Marked};
    use crate::{Cell, Page};

    #[test]
    fn value_rows_carry_their_marks_and_cells_their_heads() {
        let row = |id: &str, mark: &str| Marked {
            id: id.into(),
            marks: vec![mark.into(), "a <kind>".into()],
            cells: vec![
                Cell::Link("C1".into(), "x.html#C1".into()),
                Cell::Holds(mark == "holds", "yes".into()),
            ],
        };
        let table = Filtered {
            what: "claims".into(),
            head: vec!["id".into(), "holds".into()],
            rows: vec![row("C1", "holds"), row("", "fails")],
        };
        let mut page = Page::new("x");
        page.filtered(&table);
        let html = page.to_html();
        assert!(html.contains("<tr id=\"C1\" data-marks=\"holds\u{1f}a &lt;kind&gt;\">"), "{html}");
        assert!(html.contains("<tr data-marks=\"fails") && html.contains("<a href=\"x.html#C1\">C1</a>"));
        assert!(html.contains("data-label=\"holds\""));
    }
}
