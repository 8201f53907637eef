//! Takes the rows of a run: scalars as they come, signals where they are asked for.

use crate::plan::Plan;
use orchestrator::time::Rational;
use orchestrator::{Cell, Column, Error, Kind, Recorder, Row};
use report::tally::Tally;

/// The kept values of a signal in one run or several.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Values {
    Real(Vec<f64>),
    Integer(Vec<i32>),
    Boolean(Vec<bool>),
    Text(Vec<String>),
}

impl Values {
    pub(crate) fn of(kind: Kind) -> Self {
        match kind {
            Kind::Real => Self::Real(Vec::new()),
            Kind::Integer => Self::Integer(Vec::new()),
            Kind::Boolean => Self::Boolean(Vec::new()),
            Kind::String => Self::Text(Vec::new()),
        }
    }

    fn push(&mut self, cell: Cell<'_>) {
        match (self, cell) {
            (Self::Real(values), Cell::Real(value)) => values.push(value),
            (Self::Integer(values), Cell::Integer(value)) => values.push(value),
            (Self::Boolean(values), Cell::Boolean(value)) => values.push(value),
            (Self::Text(values), Cell::String(value)) => values.push(value.to_owned()),
            (values, cell) => debug_assert!(false, "{cell:?} among {values:?}"),
        }
    }

    /// Takes those of another run over.
    pub(crate) fn append(&mut self, other: &mut Self) {
        match (self, other) {
            (Self::Real(values), Self::Real(more)) => values.append(more),
            (Self::Integer(values), Self::Integer(more)) => values.append(more),
            (Self::Boolean(values), Self::Boolean(more)) => values.append(more),
            (Self::Text(values), Self::Text(more)) => values.append(more),
            (values, other) => debug_assert!(false, "{other:?} after {values:?}"),
        }
    }
}

/// The kept rows of one run or several.
#[derive(Debug, Clone, Default)]
pub(crate) struct Kept {
    pub(crate) times: Vec<f64>,
    pub(crate) columns: Vec<Values>,
}

/// Takes the rows of one run after the other.
pub(crate) struct CaseRecorder {
    /// Columns of the signal, and of what is taken off it.
    scalars: Vec<(usize, Option<usize>, Tally)>,
    numbers: Vec<f64>,
    signals: Vec<Column>,
    kept: Kept,
    /// A scalar has met a value that is not finite.
    not_finite: bool,
    start: Rational,
    every: Option<Rational>,
    /// Kept is the first row that is not before this, in s; so many were kept or passed over.
    next: f64,
    count: i64,
}

impl CaseRecorder {
    pub(crate) fn new(plan: &Plan) -> Self {
        let scalars = plan.scalars.iter().zip(&plan.columns);
        Self {
            scalars: scalars.map(|(scalar, (at, minus))| (*at, *minus, Tally::new(scalar.reduce))).collect(),
            numbers: Vec::new(),
            signals: plan.signals.clone(),
            kept: Kept::default(),
            not_finite: false,
            start: plan.scenario.start,
            every: plan.every,
            next: f64::NEG_INFINITY,
            count: 0,
        }
    }

    /// The scalars of the run.
    pub(crate) fn scalars(&self) -> Vec<Option<f64>> {
        self.scalars.iter().map(|(.., tally)| tally.finish()).collect()
    }

    /// Whether a signal that a scalar reads was not finite in some row.
    pub(crate) fn not_finite(&self) -> bool {
        self.not_finite
    }

    /// The kept rows of the run.
    pub(crate) fn take(&mut self) -> Kept {
        std::mem::take(&mut self.kept)
    }

    /// The next time that is due after a row: start + k·every, as exactly as the master has its points.
    fn plan_next(&mut self, time: f64) {
        let Some(every) = self.every else { return };
        let passed = ((time - self.start.to_f64()) / every.to_f64()) as i64;
        self.count = passed.max(self.count);
        loop {
            self.count += 1;
            self.next = point(self.start, every, self.count);
            if self.next > time {
                return;
            }
        }
    }
}

/// start + k·every, rounded once where that fits fractions.
fn point(start: Rational, every: Rational, k: i64) -> f64 {
    let (a, b) = (i128::from(start.numerator()), i128::from(start.denominator()));
    let (c, d) = (i128::from(every.numerator()), i128::from(every.denominator()));
    let exact = (a.checked_mul(d)).zip(c.checked_mul(b).and_then(|step| step.checked_mul(i128::from(k))));
    let exact = exact.and_then(|(from, steps)| Rational::new(from.checked_add(steps)?, b.checked_mul(d)?));
    exact.map_or_else(|| start.to_f64() + k as f64 * every.to_f64(), Rational::to_f64)
}

fn number(cell: Cell<'_>) -> f64 {
    match cell {
        Cell::Real(value) => value,
        Cell::Integer(value) => f64::from(value),
        Cell::Boolean(value) => f64::from(u8::from(value)),
        Cell::String(_) => f64::NAN,
    }
}

impl Recorder for CaseRecorder {
    fn begin(&mut self, _: &[Column]) -> Result<(), Error> {
        for (.., tally) in &mut self.scalars {
            tally.clear();
        }
        self.not_finite = false;
        self.kept.times.clear();
        self.kept.columns = self.signals.iter().map(|column| Values::of(column.kind)).collect();
        (self.next, self.count) = (f64::NEG_INFINITY, 0);
        Ok(())
    }

    fn row(&mut self, time: f64, row: Row<'_>) -> Result<(), Error> {
        self.numbers.clear();
        self.numbers.extend(row.cells().map(number));
        for (at, minus, tally) in &mut self.scalars {
            let value = self.numbers[*at] - minus.map_or(0.0, |minus| self.numbers[minus]);
            self.not_finite |= !value.is_finite();
            tally.push(time, value);
        }
        if !self.signals.is_empty() && time >= self.next {
            self.kept.times.push(time);
            // The signals are the first columns.
            self.kept.columns.iter_mut().zip(row.cells()).for_each(|(values, cell)| values.push(cell));
            self.plan_next(time);
        }
        Ok(())
    }
}
