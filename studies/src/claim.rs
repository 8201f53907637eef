//! What a study says: claims, figures and tables.

use crate::{Bench, Error};
use report::thin::thin;
use report::{Graph, Table};
use serde::{Deserialize, Serialize};

/// What a row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A numbered statement of the paper.
    Claim,
    /// Part of a statement, a figure or a table: shown beside the statements, not counted with them.
    Part,
    /// What the paper lays down and we took over: it can't fail.
    Definition,
    /// A measurement of ours that the paper makes no statement on: an answer to what it asks or leaves open.
    Measurement,
}

/// One statement of the paper, and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Its name: `C25`, or `C25.k1` for a part of it.
    pub id: String,
    /// What it is.
    pub kind: Kind,
    /// What is stated, in a short paraphrase.
    pub quantity: String,
    /// What the paper says.
    pub paper: String,
    /// What we get.
    pub ours: String,
    /// What a second correct implementation may differ by, and why.
    pub tolerance: String,
    /// Whether it holds.
    pub holds: bool,
    /// Where it does not hold, or holds for a stated choice only: why.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

impl Claim {
    /// A statement of the paper, from its `[id, quantity, paper]` and what became of it.
    pub fn new(
        [id, quantity, paper]: [&str; 3],
        ours: impl Into<String>,
        tolerance: impl Into<String>,
        holds: bool,
        note: impl Into<String>,
    ) -> Self {
        Self {
            id: id.to_owned(),
            kind: Kind::Claim,
            quantity: quantity.to_owned(),
            paper: paper.to_owned(),
            ours: ours.into(),
            tolerance: tolerance.into(),
            holds,
            note: note.into(),
        }
    }

    /// The same as a part of a statement, a figure or a table.
    #[must_use]
    pub fn part(self) -> Self {
        Self { kind: Kind::Part, ..self }
    }

    /// The same as something that the paper lays down.
    #[must_use]
    pub fn definition(self) -> Self {
        Self { kind: Kind::Definition, ..self }
    }

    /// The same as a measurement of ours.
    #[must_use]
    pub fn measurement(self) -> Self {
        Self { kind: Kind::Measurement, ..self }
    }
}

/// How many statements hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tally {
    /// Statements of the paper that were looked at, without their parts.
    pub claims: usize,
    /// Those that hold.
    pub holding: usize,
    /// What the paper lays down.
    pub definitions: usize,
    /// Figures, tables and parts of statements.
    pub parts: usize,
    /// Those that hold.
    pub parts_holding: usize,
    /// Measurements of ours.
    pub measurements: usize,
}

impl Tally {
    /// Counts rows.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Claim>) -> Self {
        let mut count = [[0; 2]; 4];
        for row in rows {
            count[row.kind as usize][usize::from(row.holds)] += 1;
        }
        let all = |kind: Kind| count[kind as usize].iter().sum();
        Self {
            claims: all(Kind::Claim),
            holding: count[Kind::Claim as usize][1],
            definitions: all(Kind::Definition),
            parts: all(Kind::Part),
            parts_holding: count[Kind::Part as usize][1],
            measurements: all(Kind::Measurement),
        }
    }
}

/// The headline: `50 of 52 statements of the paper hold`, and what stands beside them.
impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} of {} statements of the paper hold", self.holding, self.claims)?;
        let beside = [
            (self.definitions, format!("{} definitions", self.definitions)),
            (self.parts, format!("{} of {} figures, tables and parts hold", self.parts_holding, self.parts)),
            (self.measurements, format!("{} measurements of ours", self.measurements)),
        ];
        let beside: Vec<String> =
            beside.into_iter().filter(|(count, _)| *count > 0).map(|(_, text)| text).collect();
        if beside.is_empty() { Ok(()) } else { write!(f, "; beside them: {}", beside.join(", ")) }
    }
}

/// Columns of a picture, of each of which a line keeps its first, least, greatest and last point: a page of seven runs of 30 s
/// stays below 2 MB.
const COLUMNS: usize = 1000;

/// A drawn figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Inline SVG.
    pub svg: String,
    /// The graph that it was drawn from, if it was: for cursor and zoom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<Graph>,
    /// Caption; says which figure of the paper it stands beside.
    pub caption: String,
}

/// What a study returns.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
    /// Adds a picture.
    pub fn figure(&mut self, svg: String, caption: impl Into<String>) {
        self.figures.push(Figure { svg, graph: None, caption: caption.into() });
    }

    /// Adds a graph.
    ///
    /// # Errors
    /// It can't be drawn.
    pub fn graph(&mut self, mut graph: Graph, caption: impl Into<String>) -> Result<(), Error> {
        for line in &mut graph.lines {
            // In order of x: what is not is a cloud, of which every point counts.
            if line.points.windows(2).all(|pair| pair[0].0 <= pair[1].0) {
                line.points = thin(&line.points, COLUMNS);
            }
        }
        self.figures.push(Figure { svg: graph.to_svg()?, graph: Some(graph), caption: caption.into() });
        Ok(())
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
