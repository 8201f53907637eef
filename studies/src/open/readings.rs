//! What the paper leaves open of the picture, decided by Table 3: which readings give how many of its ten constants.

use crate::lens::{DISTORTIONS, Lens, STEPS_OF_ARM, on_manifold, place};
use crate::table3::{PAPER, STRENGTH, rounds_to};
use crate::walk::{Walk, through};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "table-3-readings",
    title: "Table 3: which reading of the paper gives its constants",
    claims: &["T3.readings"],
    run,
};

/// One way to read what stands in the text.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Reading {
    /// World y of the ground line.
    ground: f64,
    /// Radius of the drum, world units.
    radius: f64,
    /// Displacement of the drum over R·q₁: 1 rolls, 0 stays, −1 rolls the wrong way.
    rolls: f64,
    /// From the drum's centre to the joint, world units.
    link_1: f64,
    /// Circle 1 sits at the foot of the drum and not at its centre.
    at_the_foot: bool,
    /// (3)-(8) take distorted coordinates as arguments and not ideal ones.
    distorted: bool,
}

/// The one that the camera unit has.
const OURS: Reading =
    Reading { ground: -8.0, radius: 1.0, rolls: 1.0, link_1: 6.19, at_the_foot: false, distorted: false };

/// Name, reading, and the parameters that make the camera unit have it, where it can.
type Row = (&'static str, Reading, Option<&'static [(&'static str, f64)]>);

const READINGS: [Row; 9] = [
    (
        "as the unit has it: ground at −8, R = 1, rolling, circle 1 at the drum's centre, ideal arguments",
        OURS,
        Some(&[]),
    ),
    ("distorted coordinates as arguments of (3)-(8)", Reading { distorted: true, ..OURS }, None),
    ("circle 1 at the drum's foot", Reading { at_the_foot: true, ..OURS }, None),
    ("R = 0.9", Reading { radius: 0.9, ..OURS }, Some(&[("R", 0.9)])),
    ("R = 0: a pin on the ground line", Reading { radius: 0.0, ..OURS }, Some(&[("R", 0.0)])),
    ("no rolling", Reading { rolls: 0.0, ..OURS }, None),
    ("rolling the wrong way", Reading { rolls: -1.0, ..OURS }, None),
    ("l1 = 6.88 from the drum's centre", Reading { link_1: 6.88, ..OURS }, Some(&[("l1", 6.88)])),
    (
        "the robot in the middle of the picture: ground at −7.05",
        Reading { ground: -7.05, ..OURS },
        Some(&[("ground", -7.05)]),
    ),
];

impl Reading {
    /// Where the three circles are without distortion, image units.
    fn circles(&self, [q1, q2]: [f64; 2]) -> [[f64; 2]; 3] {
        let centre = [self.rolls * self.radius * q1, self.ground + self.radius];
        let joint = [centre[0] + self.link_1 * libm::sin(q1), centre[1] + self.link_1 * libm::cos(q1)];
        let tip = [joint[0] + 6.9 * libm::sin(q2), joint[1] + 6.9 * libm::cos(q2)];
        let first = if self.at_the_foot {
            [centre[0] - self.radius * libm::sin(q1), centre[1] - self.radius * libm::cos(q1)]
        } else {
            centre
        };
        [first, joint, tip].map(|[x, y]| [0.1 * x, 0.1 * y])
    }

    fn image(&self, lens: Lens, ideal: [f64; 2]) -> [f64; 2] {
        if !self.distorted {
            return lens.image(ideal);
        }
        // u = uᵢ + δ(u): the displacement is a tenth of u at most, so that it settles.
        (0..60).fold(ideal, |seen, _| {
            let [du, dv] = lens.displacement(seen);
            [ideal[0] + du, ideal[1] + dv]
        })
    }

    /// The largest errors of q₁ and q₂ on the manifold over the strength.
    fn constants(&self, lens: Lens) -> [f64; 2] {
        let angle = |from: [f64; 2], to: [f64; 2]| libm::atan2(to[0] - from[0], to[1] - from[1]);
        let angles = |points: [[f64; 2]; 3]| [angle(points[0], points[1]), angle(points[1], points[2])];
        let mut largest = [0.0f64; 2];
        for step in (-STEPS_OF_ARM..=STEPS_OF_ARM).step_by(5) {
            let ideal = self.circles(on_manifold(place(step)));
            // Without a lens this vision reads the true angles.
            let (without, with) = (angles(ideal), angles(ideal.map(|point| self.image(lens, point))));
            for link in [0, 1] {
                largest[link] = largest[link].max((with[link] - without[link]).abs());
            }
        }
        largest.map(|error| error / STRENGTH)
    }

    /// How many of the ten round to the paper's.
    fn agreeing(&self) -> usize {
        let constants = DISTORTIONS.map(|name| self.constants(Lens::with(name, STRENGTH)));
        count(&constants)
    }
}

fn count(constants: &[[f64; 2]]) -> usize {
    let pairs = constants.iter().flatten().zip(PAPER.iter().flatten());
    pairs.filter(|(ours, paper)| rounds_to(**ours, **paper)).count()
}

/// The same from frames of the camera unit.
fn from_frames(bench: &Bench, set: &[(&'static str, f64)]) -> Result<usize, Error> {
    let lenses = DISTORTIONS.map(|name| {
        let lens = through(Lens::with(name, STRENGTH));
        lens.into_iter().chain(set.iter().copied()).collect::<Vec<_>>()
    });
    let walks = Walk::all(bench, &lenses)?;
    let constants: Vec<[f64; 2]> =
        walks.iter().map(|walk| walk.largest().map(|error| error / STRENGTH)).collect();
    Ok(count(&constants))
}

/// The heights of the ground line with which all ten agree.
fn range() -> [f64; 2] {
    let all = |ground: f64| Reading { ground, ..OURS }.agreeing() == 10;
    let reach = |step: f64| {
        let heights = (0..40).map(|index| OURS.ground + step * f64::from(index));
        heights.take_while(|ground| all(*ground)).last().unwrap_or(f64::NAN)
    };
    [reach(-0.01), reach(0.01)]
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let mut counts = Vec::new();
    let mut rows = Vec::new();
    for (name, reading, set) in READINGS {
        let equations = reading.agreeing();
        let frames = set.map(|set| from_frames(bench, set)).transpose()?;
        rows.push(vec![
            name.into(),
            Cell::Number(format!("{equations} of 10")),
            Cell::Number(frames.map_or_else(|| "-".to_owned(), |count| format!("{count} of 10"))),
        ]);
        counts.push((equations, frames));
    }
    let [low, high] = range();
    let mut outcome = Outcome::default();
    let at = |name: &str| {
        READINGS.iter().zip(&counts).find(|((row, ..), _)| row.contains(name)).map_or(0, |(_, count)| count.0)
    };
    outcome.claims.push(
        Claim::new(
            [
                "T3.readings",
                "how many of Table 3's ten constants the readings of the text give",
                "ground, circle 1, arguments of (3)-(8): not said",
            ],
            format!(
                "ideal arguments {} of 10, distorted ones {}; circle 1 at the drum's foot {}; the robot centred in the \
                 picture {}; all ten for a ground line between {low:.2} and {high:.2}; the radius and the rolling can't \
                 be told (R = 0.9: {}, no rolling: {})",
                at("as the unit"),
                at("distorted"),
                at("foot"),
                at("middle"),
                at("R = 0.9"),
                at("no rolling")
            ),
            "the unit's reading is the only one of arguments, circle and height that gives ten",
            at("as the unit") == 10 && [at("distorted"), at("foot"), at("middle")].iter().all(|count| *count < 10),
            "",
        )
        .measurement(),
    );
    let head = ["reading", "by the equations", "from frames"].map(str::to_owned).to_vec();
    outcome.tables.push(("Constants that round to the paper's".to_owned(), Table { head, rows }));
    Ok(outcome)
}
