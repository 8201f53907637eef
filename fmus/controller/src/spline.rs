//! Interpolating B-splines of the fifth degree over uniform knots, several functions at once.
//!
//! On interval i with t in 0..1 each function is Σⱼ cᵢ₊ⱼ·wⱼ(t), j = −2..3, with the weights common to all of them.
//! The coefficients make the spline pass through the values at the knots. Four more conditions are needed: the
//! fifth derivative is continuous at the two knots next to each end ("not a knot"), since the slopes at the ends are
//! not known and natural ends would spoil the order of the error, h⁶, there.
//!
//! Source: de Boor, *A Practical Guide to Splines*, 2001.

/// Values of the basis spline at knots, times 120.
const AT_KNOTS: [f64; 5] = [1.0, 26.0, 66.0, 26.0, 1.0];
/// Jump of the fifth derivative at a knot, in coefficients.
const JUMP: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
/// The fewest intervals at which the conditions at the two ends don't overlap.
const FEWEST_INTERVALS: usize = 8;

/// `N` functions of one variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline<const N: usize> {
    start: f64,
    knots_per_unit: f64,
    coefficients: Vec<[f64; N]>,
}

impl<const N: usize> Spline<N> {
    /// The spline through `values` at `start`, `start + spacing`, and so on; `None` for fewer than nine values.
    pub fn through(start: f64, spacing: f64, values: &[[f64; N]]) -> Option<Spline<N>> {
        let intervals = values.len().checked_sub(1)?;
        if intervals < FEWEST_INTERVALS {
            return None;
        }
        let mut system = Banded::new(intervals + 5);
        system.row(0, 0, &JUMP, [0.0; N]);
        system.row(1, 1, &JUMP, [0.0; N]);
        for (knot, value) in values.iter().enumerate() {
            system.row(knot + 2, knot, &AT_KNOTS, value.map(|value| 120.0 * value));
        }
        system.row(intervals + 3, intervals - 3, &JUMP, [0.0; N]);
        system.row(intervals + 4, intervals - 2, &JUMP, [0.0; N]);
        Some(Spline { start, knots_per_unit: 1.0 / spacing, coefficients: system.solve() })
    }

    /// All functions at `x`; outside the knots the outermost polynomial goes on.
    pub fn at(&self, x: f64) -> [f64; N] {
        let (interval, t) = self.place(x);
        self.weighted(interval, weights(t))
    }

    /// Their derivatives there.
    pub fn slope(&self, x: f64) -> [f64; N] {
        let (interval, t) = self.place(x);
        self.weighted(interval, slopes(t)).map(|slope| slope * self.knots_per_unit)
    }

    fn place(&self, x: f64) -> (usize, f64) {
        let place = (x - self.start) * self.knots_per_unit;
        let last = self.coefficients.len() - 6;
        let interval = (place.max(0.0) as usize).min(last);
        (interval, place - interval as f64)
    }

    fn weighted(&self, interval: usize, weights: [f64; 6]) -> [f64; N] {
        let mut sum = [0.0; N];
        for (coefficients, weight) in self.coefficients[interval..interval + 6].iter().zip(weights) {
            for (sum, coefficient) in sum.iter_mut().zip(coefficients) {
                *sum += weight * coefficient;
            }
        }
        sum
    }
}

/// wⱼ(t), j = −2..3.
fn weights(t: f64) -> [f64; 6] {
    let u = 1.0 - t;
    [
        u * u * u * u * u / 120.0,
        (26.0 + t * (-50.0 + t * (20.0 + t * (20.0 + t * (-20.0 + t * 5.0))))) / 120.0,
        (66.0 + t * t * (-60.0 + t * t * (30.0 - t * 10.0))) / 120.0,
        (26.0 + t * (50.0 + t * (20.0 + t * (-20.0 + t * (-20.0 + t * 10.0))))) / 120.0,
        (1.0 + t * (5.0 + t * (10.0 + t * (10.0 + t * (5.0 - t * 5.0))))) / 120.0,
        t * t * t * t * t / 120.0,
    ]
}

/// wⱼ′(t), j = −2..3.
fn slopes(t: f64) -> [f64; 6] {
    let u = 1.0 - t;
    [
        -u * u * u * u / 24.0,
        (-50.0 + t * (40.0 + t * (60.0 + t * (-80.0 + t * 25.0)))) / 120.0,
        t * (-120.0 + t * t * (120.0 - t * 50.0)) / 120.0,
        (50.0 + t * (40.0 + t * (-60.0 + t * (-80.0 + t * 50.0)))) / 120.0,
        (5.0 + t * (20.0 + t * (30.0 + t * (20.0 - t * 25.0)))) / 120.0,
        t * t * t * t / 24.0,
    ]
}

/// Entries left of the diagonal.
const LEFT: usize = 6;
/// Entries right of it; pivoting doubles what the rows bring.
const RIGHT: usize = 12;

/// A banded linear system with `N` right-hand sides, solved by elimination with row pivoting.
struct Banded<const N: usize> {
    /// Row r keeps the columns r − LEFT ..= r + RIGHT.
    rows: Vec<[f64; LEFT + 1 + RIGHT]>,
    right: Vec<[f64; N]>,
}

impl<const N: usize> Banded<N> {
    fn new(size: usize) -> Banded<N> {
        Banded { rows: vec![[0.0; LEFT + 1 + RIGHT]; size], right: vec![[0.0; N]; size] }
    }

    fn row(&mut self, row: usize, first_column: usize, entries: &[f64], right: [f64; N]) {
        for (offset, entry) in entries.iter().enumerate() {
            self.rows[row][first_column + offset + LEFT - row] = *entry;
        }
        self.right[row] = right;
    }

    fn solve(mut self) -> Vec<[f64; N]> {
        let size = self.rows.len();
        for column in 0..size {
            let below = (column + LEFT + 1).min(size);
            let magnitude =
                |rows: &[[f64; LEFT + 1 + RIGHT]], row: usize| rows[row][column + LEFT - row].abs();
            let mut pivot = column;
            for row in column + 1..below {
                if magnitude(&self.rows, row) > magnitude(&self.rows, pivot) {
                    pivot = row;
                }
            }
            self.swap(column, pivot);
            for row in column + 1..below {
                self.eliminate(column, row);
            }
        }
        self.substitute()
    }

    /// Exchanges two rows, from the first one's diagonal on.
    fn swap(&mut self, upper: usize, lower: usize) {
        if upper == lower {
            return;
        }
        let shift = lower - upper;
        for place in LEFT..LEFT + 1 + RIGHT {
            let entry = self.rows[upper][place];
            self.rows[upper][place] = self.rows[lower][place - shift];
            self.rows[lower][place - shift] = entry;
        }
        self.right.swap(upper, lower);
    }

    /// Takes the entry of `row` in `column` away by means of the row on the diagonal.
    fn eliminate(&mut self, column: usize, row: usize) {
        let shift = row - column;
        let factor = self.rows[row][LEFT - shift] / self.rows[column][LEFT];
        if factor == 0.0 {
            return;
        }
        for place in LEFT..LEFT + 1 + RIGHT {
            self.rows[row][place - shift] -= factor * self.rows[column][place];
        }
        for function in 0..N {
            self.right[row][function] -= factor * self.right[column][function];
        }
    }

    fn substitute(mut self) -> Vec<[f64; N]> {
        let size = self.rows.len();
        for row in (0..size).rev() {
            let mut solution = self.right[row];
            for column in row + 1..(row + RIGHT + 1).min(size) {
                let entry = self.rows[row][column + LEFT - row];
                for (value, known) in solution.iter_mut().zip(self.right[column]) {
                    *value -= entry * known;
                }
            }
            self.right[row] = solution.map(|value| value / self.rows[row][LEFT]);
        }
        self.right
    }
}
