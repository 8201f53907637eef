//! Graphs that the browser draws, with a cursor, values and zoom: their points as packed columns inside the page, drawn by
//! uPlot with the scripts of `assets/`. Without scripts, on paper of others and for a download the same graph is there as
//! SVG.

mod pack;

use crate::extent;
use crate::graph::{Graph, Line, Marks, Style};
use crate::{Error, page};
use maud::{Markup, PreEscaped, html};
use pack::{MISSING, pack};
use serde::Serialize;
use std::collections::BTreeMap;

/// uPlot 1.6.32, as `npm pack uplot@1.6.32` gives it; `assets/uplot/README.md` has the checksums.
const UPLOT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
const UNPACK: &str = include_str!("../../assets/unpack.js");
const GRAPHS: &str = include_str!("../../assets/graphs.js");
const TOOLS: &str = include_str!("../../assets/tools.js");
const STYLE: &str = include_str!("../../assets/graphs.css");

/// The graphs of a page and the columns that they share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Live {
    /// Each packed column once as JSON, with its number.
    columns: BTreeMap<String, usize>,
    /// Each description as JSON.
    graphs: Vec<String>,
    /// What scripts of the page's own need: `id` and JSON, scripts, style.
    own: Vec<Own>,
}

/// A part of a page that has scripts of its own.
#[derive(Debug, Clone)]
struct Own {
    id: &'static str,
    json: String,
    scripts: &'static [&'static str],
    style: &'static str,
}

/// A graph as the scripts read it.
#[derive(Debug, Clone, Serialize)]
struct Described {
    title: String,
    x: String,
    y: String,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    x_log: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    x_range: Option<(f64, f64)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y_range: Option<(f64, f64)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    event: Option<(f64, String)>,
    /// Number of the column with x.
    over: usize,
    lines: Vec<DescribedLine>,
}

#[derive(Debug, Clone, Serialize)]
struct DescribedLine {
    label: String,
    style: &'static str,
    /// Each value holds until the next one.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    held: bool,
    column: usize,
}

impl Live {
    /// Whether the page needs the scripts.
    pub(crate) fn is_empty(&self) -> bool {
        self.graphs.is_empty() && self.columns.is_empty() && self.own.is_empty()
    }

    /// Takes a column for a script of the page's own.
    pub(crate) fn values(&mut self, values: &[f64]) -> Result<usize, Error> {
        let bits = |value: &f64| if value.is_finite() { value.to_bits() } else { f64::NAN.to_bits() };
        self.column(&values.iter().map(bits).collect::<Vec<_>>())
    }

    /// Takes scripts of the page's own and their data.
    pub(crate) fn own(
        &mut self,
        id: &'static str,
        json: String,
        scripts: &'static [&'static str],
        style: &'static str,
    ) {
        // What two parts of a page ask for is there once.
        if self.own.iter().all(|own| own.id != id) {
            self.own.push(Own { id, json, scripts, style });
        }
    }

    /// Takes a graph and answers its place on the page. A graph whose lines are no functions of x stays a picture.
    pub(crate) fn add(&mut self, graph: &Graph, caption: &str) -> Result<Markup, Error> {
        let svg = graph.to_svg()?;
        let Some(xs) = shared_x(&graph.lines) else { return Ok(page::figure(&svg, caption)) };
        let over = self.column(&xs.iter().map(|x| x.to_bits()).collect::<Vec<_>>())?;
        let mut lines = Vec::new();
        for line in &graph.lines {
            let label = if line.label.is_empty() { &graph.y.label } else { &line.label };
            let column = self.column(&spread(&line.points, &xs))?;
            let held = matches!(line.style, Style::Held(_));
            lines.push(DescribedLine { label: label.clone(), style: style(line.style), held, column });
        }
        let described = Described {
            title: graph.title.clone(),
            x: graph.x.label.clone(),
            y: graph.y.label.clone(),
            x_log: graph.x.log,
            x_range: graph.x.range,
            y_range: graph.y.range,
            event: graph.event.clone(),
            over,
            lines,
        };
        self.graphs.push(json(&described)?);
        let number = self.graphs.len() - 1;
        Ok(html! {
            figure.live data-graph=(number) {
                noscript { (PreEscaped(svg)) }
                @if !caption.is_empty() { figcaption { (page::inline(caption)) } }
            }
        })
    }

    fn column(&mut self, bits: &[u64]) -> Result<usize, Error> {
        let next = self.columns.len();
        Ok(*self.columns.entry(json(&pack(bits))?).or_insert(next))
    }

    /// Data and scripts, for the end of the page.
    pub(crate) fn scripts(&self) -> Markup {
        let mut columns: Vec<_> =
            self.columns.iter().map(|(packed, number)| (*number, packed.as_str())).collect();
        columns.sort_unstable();
        let columns: Vec<_> = columns.into_iter().map(|(_, packed)| packed).collect();
        let data = format!("{{\"columns\":[{}],\"graphs\":[{}]}}", columns.join(","), self.graphs.join(","));
        html! {
            (data_block("graphs", &data))
            @for own in &self.own { (data_block(own.id, &own.json)) }
            @if !self.columns.is_empty() { script { (PreEscaped(UPLOT)) } }
            script { (PreEscaped(UNPACK)) (PreEscaped(TOOLS)) (PreEscaped(GRAPHS)) }
            @for own in &self.own { script { @for script in own.scripts { (PreEscaped(script)) } } }
        }
    }

    /// The style sheets that go with the scripts.
    pub(crate) fn styles(&self) -> Markup {
        html! {
            style { (PreEscaped(UPLOT_STYLE)) (PreEscaped(STYLE)) }
            @for own in &self.own { style { (PreEscaped(own.style)) } }
        }
    }
}

/// JSON for a script of the page, which finds it by its `id`.
fn data_block(id: &str, json: &str) -> Markup {
    // Inside a script element only `<` could end it; in JSON it stands in texts only.
    html! { script type="application/json" id=(id) { (PreEscaped(json.replace('<', r"\u003c"))) } }
}

fn json(data: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(data).map_err(|why| Error::Data { why: why.to_string() })
}

/// Every x at which a line has a point, in order; none if a line goes back or stands still in x.
fn shared_x(lines: &[Line]) -> Option<Vec<f64>> {
    let goes_on = |line: &Line| {
        line.points.iter().all(|(x, _)| extent::is_drawn(*x))
            && line.points.windows(2).all(|pair| pair[0].0 < pair[1].0)
    };
    if !lines.iter().all(goes_on) {
        return None;
    }
    let mut xs: Vec<f64> = lines.iter().flat_map(|line| line.points.iter().map(|(x, _)| *x + 0.0)).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup();
    (xs.len() > 1).then_some(xs)
}

/// The values of a line at all x, and a mark where it has no point.
fn spread(points: &[(f64, f64)], xs: &[f64]) -> Vec<u64> {
    let mut points = points.iter().peekable();
    let value = |x: &f64| match points.next_if(|(at, _)| at == x) {
        Some((_, value)) if extent::is_drawn(*value) => value.to_bits(),
        Some(_) => f64::NAN.to_bits(),
        None => MISSING,
    };
    xs.iter().map(value).collect()
}

fn style(style: Style) -> &'static str {
    match style.connected() {
        Style::Solid | Style::Held(_) => "solid",
        Style::Dashed => "dashed",
        Style::Dotted => "dotted",
        Style::Points(Marks::Dot) => "dots",
        Style::Points(Marks::Cross) => "crosses",
    }
}

#[cfg(test)]
mod tests {
    use super::{Live, MISSING, shared_x, spread};
    use crate::graph::{Axis, Graph, Line};

    #[test]
    fn value_uplot_is_the_pinned_one() {
        let readme = include_str!("../../assets/uplot/README.md");
        for (name, text) in [("uPlot.iife.min.js", super::UPLOT), ("uPlot.min.css", super::UPLOT_STYLE)] {
            use sha2::Digest as _;
            let sum: String = sha2::Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect();
            assert!(readme.contains(&format!("| `{name}` | `{sum}` |")), "{name} is {sum}");
        }
    }

    #[test]
    fn law_lines_of_other_times_share_an_axis() {
        let lines = [
            Line::solid("a", vec![(0.0, 1.0), (2.0, f64::NAN)]),
            Line::solid("b", vec![(0.0, 5.0), (1.0, 6.0), (2.0, 7.0)]),
        ];
        let xs = shared_x(&lines).expect("both go on");
        assert_eq!(xs, [0.0, 1.0, 2.0]);
        assert_eq!(spread(&lines[0].points, &xs), [1.0_f64.to_bits(), MISSING, f64::NAN.to_bits()]);
        let zeros =
            [Line::solid("a", vec![(-0.0, 1.0), (1.0, 1.0)]), Line::solid("b", vec![(0.0, 1.0), (1.0, 1.0)])];
        let xs = shared_x(&zeros).expect("both go on");
        assert_eq!((xs.len(), xs[0].to_bits()), (2, 0), "zero has one sign");
        assert!(shared_x(&[Line::solid("back", vec![(0.0, 1.0), (1.0, 1.0), (0.5, 1.0)])]).is_none());
    }

    #[test]
    fn law_equal_columns_are_kept_once_and_pages_are_equal() {
        let points: Vec<(f64, f64)> = (0..50).map(|row| (f64::from(row), f64::from(row % 7))).collect();
        let graph = |title: &str| {
            Graph::new(title, Axis::fitted("time in s"), Axis::fitted("</script>"))
                .with(Line::solid("a", points.clone()))
        };
        let page = || {
            let mut live = Live::default();
            let places =
                [live.add(&graph("one"), "").expect("drawn"), live.add(&graph("two"), "c").expect("drawn")];
            assert_eq!(live.columns.len(), 2, "x and a");
            (places.map(|place| place.into_string()), live.scripts().into_string())
        };
        let (places, scripts) = page();
        assert_eq!(page(), (places.clone(), scripts.clone()));
        assert!(places[0].contains("<noscript><svg") && places[1].contains("<figcaption>c</figcaption>"));
        assert!(scripts.contains(r"\u003c/script>"), "data can't end the script");
    }
}
