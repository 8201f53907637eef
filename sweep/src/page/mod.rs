//! `report.html`: what came of the study, as curves, maps and a table.

mod pictures;

use crate::data::{self, Counts};
use crate::error::Error;
use crate::parts::Parts;
use crate::plan::Plan;
use crate::sweep::{Options, write as write_file};
use report::head::short;
use report::tally::{Reduce, Test};
use report::{Cell, Figure, Filtered, Input, Marked, Page, Provenance, Standing, Table, Verdict};
use std::path::PathBuf;

/// Scalars of which the verdict tells the smallest and the largest value.
const SPANNED: usize = 3;
/// Cases that a page lists one by one, at most: more are read by programs. Of more, failed ones that are shown.
const LISTED: u64 = 500;
const SHOWN: usize = 20;

/// The columns of numbers of all cases, NaN where there is none.
pub(crate) struct Columns {
    pub(crate) parameters: Vec<Vec<f64>>,
    pub(crate) scalars: Vec<Vec<f64>>,
}

/// Writes the page beside the parts.
pub(crate) fn write(plan: &Plan, parts: &Parts, options: &Options) -> Result<PathBuf, Error> {
    let (columns, counts, errors) = read(plan, parts)?;
    let mut page = Page::new(format!("{}: {} cases", plan.name, plan.cases()));
    page.verdict(&verdict(plan, &columns, counts));
    let provenance = provenance(plan, parts, options);
    page.origin_line(&provenance);
    pictures::draw(&mut page, plan, &columns)?;
    page.heading("Numbers of the cases").table(&numbers(plan, &columns));
    if plan.cases() <= LISTED {
        page.heading("Every case").filtered(&cases(plan, &columns, &errors));
    } else if !errors.is_empty() {
        page.heading("Failed cases").table(&failures(plan, &columns, &errors));
    }
    page.heading("The data set").text(
        "`cases/part-*.parquet` has a row for each case, in order; every tool that reads Parquet takes the folder as one \
         table. `study.toml` and `resolved.toml` say what was run.",
    );
    page.provenance(&provenance);
    let path = options.out.join("report.html");
    write_file(&path, &page.to_html())?;
    Ok(path)
}

/// Errors by their case.
type Errors = Vec<(u64, String)>;

fn read(plan: &Plan, parts: &Parts) -> Result<(Columns, Counts, Errors), Error> {
    let count = plan.parameters.len() + plan.scalars.len();
    let places: Vec<usize> = (1..=count).collect();
    let mut all = vec![Vec::new(); count];
    let (mut counts, mut errors) = (Vec::new(), Vec::new());
    let shown = if plan.cases() <= LISTED { plan.cases() as usize } else { SHOWN };
    for part in 1..=parts.of {
        let path = parts.file("cases", part);
        let first = parts.range(part).start;
        data::numbers(&path, &places, &mut all)?;
        counts.extend(data::marks(&path)?.map(|marks| marks.counts));
        let more = data::texts(&path, count + 2, shown - errors.len())?;
        errors.extend(more.into_iter().map(|(row, text)| (first + row as u64, text)));
    }
    let scalars = all.split_off(plan.parameters.len());
    Ok((Columns { parameters: all, scalars }, Counts::sum(counts.into_iter()), errors))
}

fn verdict(plan: &Plan, columns: &Columns, counts: Counts) -> Verdict {
    let (cases, failed) = (plan.cases(), counts.failed);
    let words = match failed {
        0 => format!("All {cases} cases ran."),
        _ => format!("{failed} of {cases} cases failed."),
    };
    let mut figures = Vec::new();
    for (scalar, values) in plan.scalars.iter().zip(&columns.scalars) {
        if let Reduce::FirstTrue(_) = scalar.reduce {
            let never = values.iter().filter(|value| value.is_nan()).count() as u64;
            let label = format!("cases without {}", scalar.name);
            figures.push(Figure::new(label, Some((never - failed.min(never)) as f64), ""));
        }
    }
    // What the cases span, of the first few scalars.
    for (at, scalar) in plan.scalars.iter().enumerate().take(SPANNED) {
        let there = || columns.scalars[at].iter().copied().filter(|value| value.is_finite());
        let unit = plan.scalar_units[at].clone().filter(|unit| unit != "1").unwrap_or_default();
        // of times, the words of times
        let [least, most] = match scalar.reduce {
            Reduce::FirstTrue(_) => ["earliest", "latest"],
            _ => ["smallest", "largest"],
        };
        let ends = [(least, there().reduce(f64::min)), (most, there().reduce(f64::max))];
        figures
            .extend(ends.map(|(which, value)| Figure::new(format!("{which} {}", scalar.name), value, &unit)));
    }
    let standing = if failed == 0 { Standing::Plain } else { Standing::Bad };
    let notes = plan.notices.iter().cloned().chain(counts.words()).collect();
    Verdict { standing, words, figures, notes }
}

/// What a scalar is, in words.
pub(crate) fn words(plan: &Plan, scalar: usize) -> String {
    let known = &plan.scalars[scalar];
    let signal = match &known.minus {
        Some(minus) => format!("{} - {minus}", known.signal),
        None => known.signal.clone(),
    };
    match known.reduce {
        Reduce::Last => format!("last {signal}"),
        Reduce::Min => format!("smallest {signal}"),
        Reduce::Max => format!("largest {signal}"),
        Reduce::Mean => format!("mean of {signal}"),
        Reduce::Rms => format!("rms of {signal}"),
        Reduce::Peak => format!("largest absolute value of {signal}"),
        Reduce::FirstTrue(Test::True) => format!("first time of {signal}"),
        Reduce::FirstTrue(Test::Above(limit)) => format!("first time of {signal} above {limit}"),
        Reduce::FirstTrue(Test::Below(limit)) => format!("first time of {signal} below {limit}"),
    }
}

fn numbers(plan: &Plan, columns: &Columns) -> Table {
    let head = ["column", "what", "unit", "cases with a value", "smallest", "median", "largest"];
    let row = |name: &str, what: String, unit: &Option<String>, values: &[f64]| {
        let mut there: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        there.sort_by(f64::total_cmp);
        // Of an even number of values the median lies in the middle of two.
        let between = |a: usize, b: usize| {
            let pair = there.get(a).zip(there.get(b));
            Cell::Number(pair.map_or_else(|| "-".into(), |(a, b)| short(0.5 * (a + b))))
        };
        let unit = unit.clone().unwrap_or_default();
        let count = Cell::Number(there.len().to_string());
        let last = there.len().saturating_sub(1);
        vec![
            name.into(),
            what.into(),
            unit.into(),
            count,
            between(0, 0),
            between(last / 2, there.len() / 2),
            between(last, last),
        ]
    };
    let parameters = plan.parameters.iter().zip(&columns.parameters);
    let mut rows: Vec<Vec<Cell>> = parameters
        .map(|(column, values)| row(&column.name, "parameter".into(), &column.unit, values))
        .collect();
    for (at, values) in columns.scalars.iter().enumerate() {
        rows.push(row(&plan.scalars[at].name, words(plan, at), &plan.scalar_units[at], values));
    }
    Table { head: head.map(str::to_owned).to_vec(), rows }
}

fn failures(plan: &Plan, columns: &Columns, errors: &Errors) -> Table {
    let names = plan.parameters.iter().map(|column| column.name.clone());
    let head = ["case".to_owned()].into_iter().chain(names).chain(["error".to_owned()]).collect();
    let row = |(case, error): &(u64, String)| {
        let value = |values: &Vec<f64>| {
            let value = usize::try_from(*case).ok().and_then(|case| values.get(case).copied());
            Cell::Number(value.map_or_else(String::new, short))
        };
        let mut cells = vec![Cell::Number(case.to_string())];
        cells.extend(columns.parameters.iter().map(value));
        cells.push(error.lines().next().unwrap_or_default().into());
        cells
    };
    Table { head, rows: errors.iter().map(row).collect() }
}

/// Every case, to be narrowed.
fn cases(plan: &Plan, columns: &Columns, errors: &Errors) -> Filtered {
    let names = plan.parameters.iter().map(|column| column.name.clone());
    let scalars = plan.scalars.iter().map(|scalar| scalar.name.clone());
    let head: Vec<String> =
        ["case".to_owned()].into_iter().chain(names).chain(scalars).chain(["status".to_owned()]).collect();
    let number = |values: &Vec<f64>, case: usize| match values.get(case) {
        Some(value) if !value.is_nan() => Cell::Number(short(*value)),
        _ => Cell::Number("–".to_owned()),
    };
    // A first time that never came is worth a choice of its own: did it fall?
    let events = || {
        plan.scalars.iter().enumerate().filter(|(_, scalar)| matches!(scalar.reduce, Reduce::FirstTrue(_)))
    };
    let row = |case: usize| {
        let error = errors.iter().find(|(of, _)| *of == case as u64).map(|(_, text)| text);
        let status = error.map_or("ok", |text| text.lines().next().unwrap_or_default());
        let mut marks = vec![if error.is_some() { "failed" } else { "ran" }.to_owned()];
        marks.extend(events().map(|(at, scalar)| {
            let never = columns.scalars[at].get(case).is_none_or(|value| value.is_nan());
            format!("{}{}", if never { "without " } else { "with " }, scalar.name)
        }));
        let mut cells = vec![Cell::Number(case.to_string())];
        cells.extend(columns.parameters.iter().chain(&columns.scalars).map(|values| number(values, case)));
        cells.push(match error {
            Some(_) => Cell::Holds(false, status.to_owned()),
            None => status.into(),
        });
        Marked { id: format!("case-{case}"), marks, cells }
    };
    Filtered { what: "cases".to_owned(), head, rows: (0..plan.cases() as usize).map(row).collect() }
}

fn provenance(plan: &Plan, parts: &Parts, options: &Options) -> Provenance {
    let input = Input {
        role: "study".into(),
        name: plan.name.clone(),
        sha256: crate::plan::hex(plan.text.as_bytes()),
    };
    Provenance {
        program: options.program.clone(),
        inputs: vec![input],
        changes: Vec::new(),
        units: plan.origins.clone(),
        facts: vec![
            ("scenario".into(), plan.scenario.origin.display().to_string()),
            ("cases".into(), plan.cases().to_string()),
            ("parts".into(), parts.of.to_string()),
        ],
        command: options.command.clone(),
    }
}
