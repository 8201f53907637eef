//! A run, linearised about a path: what the sweep needs and nothing else. Rows of numbers, no names.

/// One measured value against the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Place of the channel.
    pub channel: usize,
    /// Time, s.
    pub time: f64,
    /// Measured minus predicted at the path, in the channel's unit.
    pub residual: f64,
    /// Rate of change of the predicted value, in the channel's unit per s: a timestamp that is off shows in proportion to it.
    pub slope: f64,
    /// Share of the weight that noise alone would give; 0 for an outlier.
    pub weight: f64,
}

/// A state that begins where others of the first row lead it, but for a deviation of its own: Σ by x + direct δθ + ξ.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Follows {
    /// Which.
    pub state: usize,
    /// By the states before it.
    pub by: Vec<f64>,
    /// By the parameters.
    pub direct: Vec<f64>,
}

/// One run about a path x̂ of `rows` rows, with n states and p parameters.
#[derive(Debug, Clone, Default)]
pub struct Linearised {
    /// Number of states, n.
    pub states: usize,
    /// Number of parameters, p.
    pub parameters: usize,
    /// Times of the rows, s.
    pub time: Vec<f64>,
    /// ∂F/∂x of each interval, row by row (n x n numbers an interval, row-major).
    pub transition: Vec<f64>,
    /// ∂F/∂θ of each interval, a column behind the other (p columns of n numbers an interval).
    pub drive: Vec<f64>,
    /// F(x̂(k)) - x̂(k+1) of each interval (n numbers an interval, in the states' units).
    pub defect: Vec<f64>,
    /// What each interval ends with when the inputs act later than their timestamps say: ∂F/∂(time), per s, as many numbers an interval as
    /// the machine has states. Empty: nothing is fed.
    pub late: Vec<f64>,
    /// Where the values of each row begin in `measured`; one more than rows.
    pub first: Vec<usize>,
    /// The measured values, in the order of rows.
    pub measured: Vec<Measured>,
    /// ∂h/∂x of each value (n numbers a value).
    pub observe: Vec<f64>,
    /// ∂h/∂θ of each value (p numbers a value).
    pub direct: Vec<f64>,
    /// Whether nobody knows what was fed in each interval: the state behind it is as unknown as the first.
    /// Empty: none is.
    pub torn: Vec<bool>,
    /// Deviance that values would have had which are left out because of where a parameter puts them (before the run's begin, by a
    /// sensor's delay; or where what acts was fed before it, by an input's): without it a model that leaves them out is likelier, or not,
    /// by the unit of measurement.
    pub left_out: f64,
    /// Prior of the deviation of the first row's state: mean and standard deviation (n each).
    pub start: (Vec<f64>, Vec<f64>),
    /// States of which the prior is about where others lead.
    pub follows: Vec<Follows>,
}

impl Linearised {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time.len()
    }

    /// The values of a row, as places in `measured`.
    pub fn values(&self, row: usize) -> std::ops::Range<usize> {
        self.first[row]..self.first[row + 1]
    }

    /// Whether nobody knows what was fed after a row.
    pub fn is_torn(&self, row: usize) -> bool {
        self.torn.get(row).copied().unwrap_or(false)
    }

    /// What an interval ends with when the inputs act later, per s; states behind those of the machine don't know of it, nor does one that
    /// nothing is known of.
    pub fn late(&self, row: usize) -> &[f64] {
        let each = self.late.len() / (self.rows() - 1).max(1);
        if self.is_torn(row) { &[] } else { &self.late[row * each..(row + 1) * each] }
    }

    /// Length of the interval after a row, s.
    pub fn interval(&self, row: usize) -> f64 {
        self.time[row + 1] - self.time[row]
    }

    /// ∂F/∂θ of one interval and parameter.
    pub fn column(&self, row: usize, parameter: usize) -> &[f64] {
        let at = (row * self.parameters + parameter) * self.states;
        &self.drive[at..at + self.states]
    }

    /// This run with the columns of these parameters only, in this order.
    pub fn with_columns(&self, columns: &[usize]) -> Self {
        let rows = 0..self.rows().saturating_sub(1);
        let drive = rows.flat_map(|row| columns.iter().flat_map(move |column| self.column(row, *column)));
        let direct = (0..self.measured.len()).flat_map(|value| {
            columns.iter().map(move |column| self.direct[value * self.parameters + column])
        });
        let follows = |known: &Follows| {
            let direct = columns.iter().map(|column| known.direct[*column]).collect();
            Follows { direct, ..known.clone() }
        };
        Self {
            parameters: columns.len(),
            drive: drive.copied().collect(),
            direct: direct.collect(),
            states: self.states,
            time: self.time.clone(),
            transition: self.transition.clone(),
            defect: self.defect.clone(),
            first: self.first.clone(),
            measured: self.measured.clone(),
            observe: self.observe.clone(),
            late: self.late.clone(),
            torn: self.torn.clone(),
            left_out: self.left_out,
            start: self.start.clone(),
            follows: self.follows.iter().map(follows).collect(),
        }
    }

    /// This run about the same path, after the parameters moved by `shift` (place, amount), to first order.
    pub fn shifted(&self, shift: &[(usize, f64)]) -> Self {
        let mut moved = self.clone();
        for (place, by) in shift.iter().filter(|(_, by)| *by != 0.0) {
            for known in &self.follows {
                moved.start.0[known.state] += by * known.direct[*place];
            }
            for row in 0..self.rows().saturating_sub(1) {
                for (state, column) in self.column(row, *place).iter().enumerate() {
                    moved.defect[row * self.states + state] += by * column;
                }
            }
            for (value, measured) in moved.measured.iter_mut().enumerate() {
                measured.residual -= by * self.direct[value * self.parameters + place];
            }
        }
        moved
    }
}
