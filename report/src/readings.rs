//! A map whose cells tell their values: by the mouse, by a finger, or by the arrow keys.

use crate::map::HeatMap;
use crate::page::{self, inline};
use crate::{Error, Page};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

/// What the cells of a map stand for, in the order of the cells.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Readings {
    /// Labels of x, y, and the value.
    pub labels: [String; 3],
    /// Middles of the columns, as values of x.
    pub x: Vec<f64>,
    /// Middles of the rows.
    pub y: Vec<f64>,
    /// Values, row by row; `NaN`: none.
    #[serde(serialize_with = "holes")]
    pub values: Vec<f64>,
}

fn holes<S: serde::Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(values.iter().map(|value| value.is_finite().then_some(*value)))
}

const SCRIPT: &str = include_str!("../assets/maps.js");
const STYLE: &str = include_str!("../assets/maps.css");

impl Page {
    /// A map for a place that the caller chooses; its cells answer to the reader. Values that are finite must be cells of the map.
    ///
    /// # Errors
    /// It can't be drawn.
    pub fn map(&mut self, map: &HeatMap, readings: &Readings, caption: &str) -> Result<Markup, Error> {
        let svg = map.to_svg()?;
        let data = serde_json::to_string(readings).map_err(|why| Error::Data { why: why.to_string() })?;
        self.scripted("maps", "null".to_owned(), &[SCRIPT], STYLE);
        let named = page::named(&svg, caption);
        Ok(html! { figure.map data-map=(data) {
            (PreEscaped(named))
            @if !caption.is_empty() { figcaption { (inline(caption)) } }
        } })
    }
}
