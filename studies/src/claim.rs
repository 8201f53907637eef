//! What a study says: claims, figures and tables.

use crate::{Bench, Error};
use report::Table;
use serde::Serialize;

/// One statement of the paper, and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Name in the list of targets, e.g. `C25` or `C25.k1`.
    pub id: String,
    /// What is stated, in a short paraphrase.
    pub quantity: String,
    /// What the paper says.
    pub paper: String,
    /// What we get.
    pub ours: String,
    /// What a second honest implementation may differ by, and why.
    pub tolerance: String,
    /// Whether it holds.
    pub holds: bool,
    /// Where it does not hold, or holds for a stated choice only: why.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

impl Claim {
    /// A claim from its `[id, quantity, paper]` and what became of it.
    pub fn new(
        [id, quantity, paper]: [&str; 3],
        ours: impl Into<String>,
        tolerance: impl Into<String>,
        holds: bool,
        note: impl Into<String>,
    ) -> Self {
        Self {
            id: id.to_owned(),
            quantity: quantity.to_owned(),
            paper: paper.to_owned(),
            ours: ours.into(),
            tolerance: tolerance.into(),
            holds,
            note: note.into(),
        }
    }
}

/// A drawn figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Inline SVG.
    pub svg: String,
    /// Caption; says which figure of the paper it stands beside.
    pub caption: String,
}

/// What a study returns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// Statements.
    pub claims: Vec<Claim>,
    /// Figures, in order.
    pub figures: Vec<Figure>,
    /// Tables, each with a title.
    pub tables: Vec<(String, Table)>,
    /// Paragraphs that explain choices and conflicts.
    pub notes: Vec<String>,
}

impl Outcome {
    /// Adds a drawn graph.
    pub fn figure(&mut self, svg: String, caption: impl Into<String>) {
        self.figures.push(Figure { svg, caption: caption.into() });
    }
}

/// One file of this crate.
pub struct Study {
    /// Name on the command line, e.g. `table-3`.
    pub id: &'static str,
    /// Heading on the page.
    pub title: &'static str,
    /// The claims of the list of targets that it decides.
    pub claims: &'static [&'static str],
    /// Does it.
    pub run: fn(&Bench) -> Result<Outcome, Error>,
}

impl Study {
    /// Whether it is meant by a name: its own, or one of its claims'.
    pub fn answers_to(&self, name: &str) -> bool {
        self.id.eq_ignore_ascii_case(name) || self.claims.iter().any(|claim| claim.eq_ignore_ascii_case(name))
    }
}
