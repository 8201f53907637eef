//! The camera unit looking at a robot at rest, pose by pose, through FMI; estimation errors along the manifold.

use crate::lens::{self, Lens, STEPS_OF_ARM};
use crate::unit::{Signal, Unit};
use crate::{Bench, Error};
use rayon::prelude::*;
use report::{Axis, Graph, Line};

/// Start values of the camera's rate, Hz.
const RATE: f64 = 30.0;
/// Half of the picture's width, px.
pub const HALF_WIDTH: f64 = 256.0;
/// With p₂ = 0.1 a circle covers 33 to 119 px: everything from a lens study is taken with these limits.
pub const WIDE_AREAS: [(&str, f64); 2] = [("N_min", 20.0), ("N_max", 200.0)];

/// What the camera made of one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Actual (q₁, q₂).
    pub pose: [f64; 2],
    /// Estimated (q₁, q₂); not a number where the circles were not identified.
    pub estimate: [f64; 2],
    /// Whether they were.
    pub valid: bool,
    /// Centroids in pixels from the centre of the picture, v up.
    pub centroids_px: [[f64; 2]; 3],
    /// Areas in pixels.
    pub areas: [f64; 3],
}

impl Look {
    /// Actual less estimated (q₁, q₂).
    pub fn error(&self) -> [f64; 2] {
        [self.pose[0] - self.estimate[0], self.pose[1] - self.estimate[1]]
    }
}

/// A camera that is shown poses at rest.
pub struct Eye {
    unit: Unit,
    frame: i64,
    inputs: [Signal; 2],
    outputs: [Signal; 12],
}

impl Eye {
    /// A camera unit.
    ///
    /// # Errors
    /// It can't be loaded.
    pub fn new(bench: &Bench) -> Result<Self, Error> {
        const OUTPUTS: [&str; 12] =
            ["valid", "q1_est", "q2_est", "u1", "v1", "u2", "v2", "u3", "v3", "area1", "area2", "area3"];
        let unit = bench.unit("acrobot_camera")?;
        let inputs = [unit.signal("q1")?, unit.signal("q2")?];
        let mut outputs = [inputs[0]; 12];
        for (output, name) in outputs.iter_mut().zip(OUTPUTS) {
            *output = unit.signal(name)?;
        }
        Ok(Self { unit, frame: 0, inputs, outputs })
    }

    /// Starts anew with these parameters before a first pose. Another number of the first frame gives other noise.
    ///
    /// # Errors
    /// The unit refuses a value.
    pub fn start(&mut self, pose: [f64; 2], set: &[(&str, f64)], first_frame: i64) -> Result<Look, Error> {
        let [q1, q2] = pose;
        let set: Vec<_> = set.iter().copied().chain([("q1", q1), ("q2", q2)]).collect();
        self.frame = first_frame;
        self.unit.start(first_frame as f64 / RATE, &set)?;
        self.read(pose)
    }

    /// Sets a tunable parameter between two looks.
    ///
    /// # Errors
    /// The unit refuses the value.
    pub fn tune(&mut self, name: &str, value: f64) -> Result<(), Error> {
        self.unit.set(name, value)
    }

    /// Goes to a pose and looks at it. The way takes half a period; then the robot rests until the frame is taken.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn look(&mut self, pose: [f64; 2]) -> Result<Look, Error> {
        for (input, angle) in self.inputs.into_iter().zip(pose) {
            self.unit.write(input, angle)?;
        }
        let time = |halves: i64| halves as f64 / (2.0 * RATE);
        let [from, middle, to] = [0, 1, 2].map(|half| time(2 * self.frame + half));
        self.unit.step(from, middle - from)?;
        self.unit.step(middle, to - middle)?;
        self.frame += 1;
        self.read(pose)
    }

    fn read(&mut self, pose: [f64; 2]) -> Result<Look, Error> {
        let mut values = [0.0; 12];
        for (value, output) in values.iter_mut().zip(self.outputs) {
            *value = self.unit.read(output)?;
        }
        let [valid, q1, q2, u1, v1, u2, v2, u3, v3, areas @ ..] = values;
        let valid = valid != 0.0;
        Ok(Look {
            pose,
            estimate: if valid { [q1, q2] } else { [f64::NAN; 2] },
            valid,
            centroids_px: [[u1, v1], [u2, v2], [u3, v3]],
            areas,
        })
    }
}

/// What the camera made of every place of [`lens::places`], in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    /// One look a place.
    pub looks: Vec<Look>,
}

impl Walk {
    /// Shows the camera both arms of the manifold, each from the upright outwards: identification needs small steps.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn new(bench: &Bench, set: &[(&str, f64)]) -> Result<Self, Error> {
        Self::beside(bench, set, [0.0; 2])
    }

    /// The same beside the manifold.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn beside(bench: &Bench, set: &[(&str, f64)], offset: [f64; 2]) -> Result<Self, Error> {
        let mut eye = Eye::new(bench)?;
        let pose = |step: i32| {
            let [q1, q2] = lens::on_manifold(lens::place(step));
            [q1 + offset[0], q2 + offset[1]]
        };
        let mut arm = |side: i32, first_frame: i64| -> Result<Vec<Look>, Error> {
            let mut looks = vec![eye.start(pose(0), set, first_frame)?];
            for step in 1..=STEPS_OF_ARM {
                looks.push(eye.look(pose(side * step))?);
            }
            Ok(looks)
        };
        let left = arm(-1, i64::from(STEPS_OF_ARM) + 1)?;
        let right = arm(1, 0)?;
        let looks = left.into_iter().skip(1).rev().chain(right).collect();
        Ok(Self { looks })
    }

    /// The walks of several settings, side by side.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn all(bench: &Bench, settings: &[Vec<(&str, f64)>]) -> Result<Vec<Self>, Error> {
        settings.par_iter().map(|set| Self::new(bench, set)).collect()
    }

    /// Actual less estimated (q₁, q₂) at each place.
    pub fn errors(&self) -> Vec<[f64; 2]> {
        self.looks.iter().map(Look::error).collect()
    }

    /// The largest error of q₁ and of q₂, by amount, where the circles were identified; not a number if nowhere.
    pub fn largest(&self) -> [f64; 2] {
        if self.lost() == self.looks.len() { [f64::NAN; 2] } else { largest(&self.errors()) }
    }

    /// Root mean square of the error of q₁ and of q₂, where the circles were identified.
    pub fn rms(&self) -> [f64; 2] {
        rms(&self.errors())
    }

    /// At how many places the circles were not identified.
    pub fn lost(&self) -> usize {
        self.looks.iter().filter(|look| !look.valid).count()
    }

    /// The smallest and the largest area of an identified circle, px.
    pub fn areas(&self) -> [f64; 2] {
        let areas = self.looks.iter().filter(|look| look.valid).flat_map(|look| look.areas);
        areas.fold([f64::INFINITY, 0.0], |[low, high], area| [low.min(area), high.max(area)])
    }

    /// The mean area of an identified circle, px.
    pub fn mean_area(&self) -> f64 {
        let areas: Vec<f64> =
            self.looks.iter().filter(|look| look.valid).flat_map(|look| look.areas).collect();
        areas.iter().sum::<f64>() / areas.len() as f64
    }
}

/// The parameters of the camera unit for a lens study.
pub fn through(lens: Lens) -> Vec<(&'static str, f64)> {
    lens.settings().into_iter().chain(WIDE_AREAS).collect()
}

/// The same with 2048 × 2048 px, where a circle covers 16 times as many.
pub fn finely_through(lens: Lens) -> Vec<(&'static str, f64)> {
    let areas = WIDE_AREAS.map(|(name, area)| (name, 16.0 * area));
    lens.settings().into_iter().chain(areas).chain([("width", 2048.0), ("height", 2048.0)]).collect()
}

/// By which factor one curve of errors is another, by least squares over both links: 1 if they agree in sign and size.
pub fn gain(seen: &[[f64; 2]], said: &[[f64; 2]]) -> f64 {
    let pairs = seen.iter().flatten().zip(said.iter().flatten()).filter(|(seen, _)| seen.is_finite());
    let (product, square) = pairs
        .fold((0.0, 0.0), |(product, square), (seen, said)| (product + seen * said, square + said * said));
    product / square
}

/// Errors averaged over this many places to each side, fewer towards the ends: the lattice of pixels is no part of a
/// curve's shape.
pub fn smoothed(errors: &[[f64; 2]], reach: usize) -> Vec<[f64; 2]> {
    let mean_around = |index: usize| {
        // As many on both sides, so that a slope is kept.
        let reach = reach.min(index).min(errors.len() - 1 - index);
        let around = &errors[index - reach..=index + reach];
        [0, 1].map(|link| around.iter().map(|error| error[link]).sum::<f64>() / around.len() as f64)
    };
    (0..errors.len()).map(mean_around).collect()
}

/// What the equations say at each place of [`lens::places`].
pub fn by_equations(lens: Lens) -> Vec<[f64; 2]> {
    lens::places().into_iter().map(|q2| lens.error(q2)).collect()
}

/// The largest of both errors by amount; what is not a number doesn't count.
pub fn largest(errors: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|link| errors.iter().map(|error| error[link].abs()).fold(0.0, f64::max))
}

/// Root mean square of both errors; what is not a number doesn't count.
pub fn rms(errors: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|link| {
        let squares =
            errors.iter().map(|error| error[link] * error[link]).filter(|square| square.is_finite());
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        f64::sqrt(sum / count)
    })
}

/// The larger of two numbers; not a number if one of them is none, so that no claim holds by what wasn't measured.
pub fn larger(first: f64, second: f64) -> f64 {
    if first.is_nan() || first > second { first } else { second }
}

/// The larger of both links' numbers.
pub fn worse([first, second]: [f64; 2]) -> f64 {
    larger(first, second)
}

/// A graph as in Figures 12 to 18: error over q₂, that of q₁ solid, that of q₂ dashed; a point every 20 mrad.
pub fn error_graph(title: &str, errors: &[[f64; 2]]) -> Graph {
    let of = |link: usize| {
        let points = lens::places().into_iter().zip(errors).map(|(q2, error)| (q2, error[link]));
        points.step_by(4).collect::<Vec<_>>()
    };
    let lines = [Line::solid("q₁", of(0)), Line::dashed("q₂", of(1))];
    framed(title, "q₂ in rad", "actual − estimated in rad", lines)
}

/// A graph over both arms of the manifold with room for its legend above the lines.
pub fn framed(title: &str, x: &str, y: &str, lines: impl IntoIterator<Item = Line>) -> Graph {
    let lines: Vec<Line> = lines.into_iter().collect();
    let values = lines.iter().flat_map(|line| &line.points).map(|(_, y)| *y).filter(|y| y.is_finite());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    let span = high - low;
    let room = 0.05 + 0.08 * lines.iter().filter(|line| !line.label.is_empty()).count() as f64;
    let y = Axis::over(y, low - 0.05 * span, high + room * span);
    Graph { title: title.to_owned(), x: Axis::over(x, -2.5, 2.5), y, lines, event: None }
}

/// What stands in a table where there is no number.
pub const NOTHING: &str = "-";

/// Two numbers with so many decimals, q₁'s first.
pub fn pair(values: [f64; 2], decimals: usize) -> String {
    format!("{:.decimals$} / {:.decimals$}", values[0], values[1])
}

/// Two small numbers in powers of ten, q₁'s first.
pub fn small(values: [f64; 2]) -> String {
    if values.iter().any(|value| value.is_nan()) {
        return NOTHING.to_owned();
    }
    format!("{:.1e} / {:.1e}", values[0], values[1])
}
