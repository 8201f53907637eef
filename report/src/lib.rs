//! Graphs, tables and pages: what a person sees of a run, a claim or a diagnosis.
//!
//! Data comes in as numbers and leaves as one self-contained HTML file: graphs are drawn by the page's own scripts or are
//! inline SVG, pictures are inline PNG, nothing is fetched from anywhere. This crate knows no unit and no signal by name.

#![forbid(unsafe_code)]

mod clip;
mod compact;
pub mod extent;
pub mod field;
pub mod filter;
pub mod graph;
pub mod head;
mod legend;
mod live;
pub mod map;
pub mod page;
pub mod picture;
pub mod readings;
mod style;
pub mod tally;
pub mod thin;
pub mod timing;

pub use field::VectorField;
pub use filter::{Filtered, Marked};
pub use graph::{Axis, Graph, Line, Marks, Stroke, Style};
pub use head::{Change, Figure, Input, Origin, Program, Provenance, Standing, Verdict};
pub use map::{Bar, Contour, HeatMap};
pub use maud::{Markup, PreEscaped};
pub use page::{Cell, Page, Table};
pub use picture::Picture;
pub use readings::Readings;
pub use timing::TimingDiagram;

/// What can go wrong while drawing.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The drawing library refused.
    #[error("can't draw `{title}`: {why}")]
    Draw {
        /// Title of the graph.
        title: String,
        /// What the drawing library says.
        why: String,
    },
    /// Text for the page's scripts.
    #[error("can't write the data of a graph: {why}")]
    Data {
        /// What the library says.
        why: String,
    },
    /// Nothing to draw.
    #[error("can't draw `{title}`: it has no finite point")]
    Empty {
        /// Title of the graph.
        title: String,
    },
}
