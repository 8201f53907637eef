//! Pictures of scalars over parameters: curves over one, maps over two, points where cases lie anyhow.

use super::{Columns, words};
use crate::design::Design;
use crate::error::Error;
use crate::plan::Plan;
use report::extent;
use report::head::short;
use report::{Axis, Bar, Graph, HeatMap, Line, Markup, Page, Readings};

/// Pictures of one scalar, at most, and points of one picture.
const PICTURES: usize = 6;
const POINTS: usize = 4000;
/// Share of the full colour that the smallest value of a map has.
const PALE: f64 = 0.25;

/// A parameter with several values, as an axis.
struct Varied {
    parameter: usize,
    label: String,
    /// Numbers of its values; their places where they are none.
    values: Vec<f64>,
}

/// All of them.
pub(super) fn draw(page: &mut Page, plan: &Plan, columns: &Columns) -> Result<(), Error> {
    for (at, scalar) in plan.scalars.iter().enumerate() {
        let values = &columns.scalars[at];
        if !values.iter().any(|value| extent::is_drawn(*value)) {
            page.heading(&scalar.name).text(&format!("No case has a finite value: {}.", words(plan, at)));
            continue;
        }
        let pictures = match plan.sampler.design() {
            Design::Grid(axes) => over_grid(page, plan, axes.iter().map(Vec::len).collect(), columns, at)?,
            _ => points(page, plan, columns, at)?,
        };
        page.heading(&scalar.name).side_by_side(&pictures);
    }
    Ok(())
}

fn labelled(name: &str, unit: &Option<String>) -> String {
    match unit.as_deref() {
        None | Some("" | "1") => name.to_owned(),
        Some(unit) => format!("{name} in {unit}"),
    }
}

fn label(plan: &Plan, scalar: usize) -> String {
    labelled(&plan.scalars[scalar].name, &plan.scalar_units[scalar])
}

/// How many cases of a grid lie between neighbours along an axis.
fn stride(lengths: &[usize], parameter: usize) -> usize {
    lengths[parameter + 1..].iter().product()
}

/// The axis of a parameter. Values that are no numbers are told by their places.
fn along(plan: &Plan, lengths: &[usize], columns: &Columns, parameter: usize) -> Varied {
    let column = &plan.parameters[parameter];
    let value = |place: usize| columns.parameters[parameter][place * stride(lengths, parameter)];
    let numbers: Vec<f64> = (0..lengths[parameter]).map(value).collect();
    let values = match numbers.iter().all(|number| extent::is_drawn(*number)) {
        true => numbers,
        false => (0..lengths[parameter]).map(|place| place as f64).collect(),
    };
    Varied { parameter, label: labelled(&column.name, &column.unit), values }
}

fn over_grid(
    page: &mut Page,
    plan: &Plan,
    lengths: Vec<usize>,
    columns: &Columns,
    scalar: usize,
) -> Result<Vec<Markup>, Error> {
    let stride = |parameter: usize| stride(&lengths, parameter);
    let varied: Vec<Varied> = (0..lengths.len())
        .filter(|parameter| lengths[*parameter] > 1)
        .map(|parameter| along(plan, &lengths, columns, parameter))
        .collect();
    let values = &columns.scalars[scalar];
    match varied.as_slice() {
        [] => Ok(Vec::new()),
        [only] => Ok(vec![curve(page, plan, only, values, scalar)?]),
        [others @ .., y, x] => {
            let (along_x, along_y) = (stride(x.parameter), stride(y.parameter));
            let combinations: usize = others.iter().map(|other| other.values.len()).product();
            let mut picture = |mut combination: usize| {
                let (mut first, mut beside) = (0, Vec::new());
                for other in others.iter().rev() {
                    let place = combination % other.values.len();
                    combination /= other.values.len();
                    first += place * stride(other.parameter);
                    beside.push(format!(
                        "{} = {}",
                        plan.parameters[other.parameter].name,
                        short(other.values[place])
                    ));
                }
                let value = |row: usize, column: usize| values[first + row * along_y + column * along_x];
                map(page, plan, [x, y], &value, &beside, scalar)
            };
            let shown = combinations.min(PICTURES);
            // Evenly among all, the first and the last among them.
            let chosen = (0..shown).map(|at| at * (combinations - 1) / (shown - 1).max(1));
            chosen.map(&mut picture).collect()
        }
    }
}

fn curve(
    page: &mut Page,
    plan: &Plan,
    axis: &Varied,
    values: &[f64],
    scalar: usize,
) -> Result<Markup, Error> {
    let mut points: Vec<(f64, f64)> = axis.values.iter().copied().zip(values.iter().copied()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut across = Axis::fitted(&axis.label);
    across.log = is_geometric(&points);
    let graph = Graph::new(words(plan, scalar), across, Axis::fitted(label(plan, scalar)))
        .with(Line::solid("from case to case", points.clone()))
        .with(Line::dots("cases", points));
    Ok(page.place(&graph, &format!("{}; no point where there is no value.", words(plan, scalar)))?)
}

fn map(
    page: &mut Page,
    plan: &Plan,
    [x, y]: [&Varied; 2],
    value: &dyn Fn(usize, usize) -> f64,
    beside: &[String],
    scalar: usize,
) -> Result<Markup, Error> {
    let (columns, rows) = (order(&x.values), order(&y.values));
    let cells = rows.iter().flat_map(|row| columns.iter().map(move |column| (*row, *column)));
    let raw: Vec<f64> = cells.map(|(row, column)| value(row, column)).collect();
    let reached = extent::of(raw.iter().copied());
    let (low, high) = reached.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
    // Larger is darker, on every map; pale still differs from white, which is no value.
    let shade =
        |value: f64| if high > low { PALE + (1.0 - PALE) * (value - low) / (high - low) } else { 1.0 };
    let log = logarithmic(&x.values);
    let xs: Vec<f64> =
        columns.iter().map(|at| if log { x.values[*at].log10() } else { x.values[*at] }).collect();
    let ys: Vec<f64> = rows.iter().map(|at| y.values[*at]).collect();
    let (x_edges, y_edges) = (edges(&xs), edges(&ys));
    let span = |edges: &[f64]| (edges[0], edges[edges.len() - 1]);
    let ((left, right), (bottom, top)) = (span(&x_edges), span(&y_edges));
    let drawn = HeatMap {
        title: beside.join(", "),
        x: Axis::over(&x.label, left, right),
        y: Axis::over(&y.label, bottom, top),
        log_x: log,
        ticks: [xs.clone(), ys.clone()],
        x_edges,
        y_edges,
        values: raw
            .iter()
            .map(|value| if extent::is_drawn(*value) { shade(*value) } else { f64::NAN })
            .collect(),
        contours: Vec::new(),
        bar: reached
            .map(|_| Bar { label: label(plan, scalar), ends: [(shade(low), low), (shade(high), high)] }),
    };
    let holes = if raw.iter().all(|value| extent::is_drawn(*value)) {
        ""
    } else {
        "; a cell without a colour has no value"
    };
    let readings = Readings {
        labels: [x.label.clone(), y.label.clone(), label(plan, scalar)],
        x: columns.iter().map(|at| x.values[*at]).collect(),
        y: rows.iter().map(|at| y.values[*at]).collect(),
        values: raw,
    };
    Ok(page.map(&drawn, &readings, &format!("{}{holes}.", words(plan, scalar)))?)
}

/// Places in rising order of the values.
fn order(values: &[f64]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..values.len()).collect();
    places.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    places
}

/// A wide axis is drawn by its logarithm.
fn logarithmic(values: &[f64]) -> bool {
    let (low, high) =
        values.iter().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(*v), high.max(*v)));
    low > 0.0 && high / low >= 20.0
}

/// Whether rising values have even steps of the logarithm, as `scale = "log"` makes them.
fn is_geometric(points: &[(f64, f64)]) -> bool {
    let ratio = |pair: &[(f64, f64)]| pair[1].0 / pair[0].0;
    let first = points.get(..2).map_or(f64::NAN, ratio);
    let even = |pair: &[(f64, f64)]| pair[0].0 > 0.0 && (ratio(pair) / first - 1.0).abs() < 1e-9;
    points.len() > 2 && first > 1.0 && points.windows(2).all(even)
}

/// Half-way between neighbours; the outer ones as far outside.
fn edges(values: &[f64]) -> Vec<f64> {
    let middle = |a: f64, b: f64| 0.5 * (a + b);
    let (first, last) = (values[0], values[values.len() - 1]);
    let mut edges = vec![first - (middle(first, values[1.min(values.len() - 1)]) - first)];
    edges.extend(values.windows(2).map(|pair| middle(pair[0], pair[1])));
    edges.push(last + (last - edges[edges.len() - 1]));
    edges
}

/// A scalar over each parameter, a point a case.
fn points(page: &mut Page, plan: &Plan, columns: &Columns, scalar: usize) -> Result<Vec<Markup>, Error> {
    let values = &columns.scalars[scalar];
    let every = values.len().div_ceil(POINTS).max(1);
    let mut pictures = Vec::new();
    let shown = plan
        .parameters
        .iter()
        .zip(&columns.parameters)
        .enumerate()
        .filter(|(_, (_, x))| x.iter().all(|x| extent::is_drawn(*x)));
    for (at, (column, x)) in shown.take(PICTURES) {
        let all = x.iter().copied().zip(values.iter().copied());
        let mut points: Vec<(f64, f64)> =
            all.step_by(every).filter(|(_, value)| extent::is_drawn(*value)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if points.is_empty() {
            continue;
        }
        let thinned = if every > 1 { format!(", every {every}th case") } else { String::new() };
        let mut across = Axis::fitted(labelled(&column.name, &column.unit));
        across.log = matches!(plan.sampler.design(), Design::Sampled(sampled) if sampled.ranges[at].log);
        let graph = Graph::new(words(plan, scalar), across, Axis::fitted(label(plan, scalar)))
            .with(Line::dots("cases", points));
        pictures.push(page.place(&graph, &format!("{}, a point a case{thinned}.", words(plan, scalar)))?);
    }
    Ok(pictures)
}

#[cfg(test)]
mod tests {
    use super::{edges, is_geometric, logarithmic, order};

    #[test]
    fn value_edges_lie_half_way() {
        assert_eq!(edges(&[1.0, 2.0, 4.0]), [0.5, 1.5, 3.0, 5.0]);
        assert_eq!(order(&[3.0, 1.0, 2.0]), [1, 2, 0]);
        let over = |values: [f64; 3]| is_geometric(&values.map(|x| (x, 0.0)));
        assert!(over([0.1, 1.0, 10.0]) && !over([1.0, 2.0, 3.0]) && !over([2.0, 2.0, 2.0]));
        assert!(!over([-1.0, 1.0, -1.0]) && !is_geometric(&[(1.0, 0.0), (2.0, 0.0)]));
        assert!(logarithmic(&[5.0, 240.0]) && !logarithmic(&[0.0, 100.0]) && !logarithmic(&[15.0, 240.0]));
    }
}
