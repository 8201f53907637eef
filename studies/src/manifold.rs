//! Figure 11 and Section 3.1: the manifold of equilibria, how unstable it is, and what pseudolinearization makes of it,
//! measured on the plant and controller units.

use crate::lens;
use crate::unit::Unit;
use crate::walk::larger;
use crate::{Bench, Claim, Error, Outcome, Study};
use mechanics::{Theta, place::ARM_END};
use report::{Axis, Cell, Graph, Line, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "figure-11",
    title: "Figure 11: the equilibrium manifold",
    claims: &["C10", "C11", "C12", "C13"],
    run,
};

/// Places on both arms at which the units are measured.
const PLACES: i32 = 24;
/// Distance of the points of a difference quotient, rad or rad/s.
const REACH: f64 = 2e-3;

/// The plant at rest near an equilibrium.
struct Rig {
    plant: Unit,
    controller: Unit,
}

impl Rig {
    /// (q̈₁, q̈₂) at rest.
    fn accelerations(&mut self, [q1, q2]: [f64; 2], tau: f64) -> Result<[f64; 2], Error> {
        self.plant.start(0.0, &[("q1_0", q1), ("q2_0", q2), ("tau", tau), ("q2_max", 10.0)])?;
        Ok([self.plant.get("ddq1")?, self.plant.get("ddq2")?])
    }

    /// z of the plant at rest.
    fn z(&mut self, q: [f64; 2]) -> Result<f64, Error> {
        self.accelerations(q, 0.0)?;
        self.plant.get("z")
    }

    /// q₁ and τ at which the plant stays at rest, by Newton's method on the unit's accelerations.
    fn equilibrium(&mut self, q2: f64) -> Result<[f64; 2], Error> {
        let [mut q1, mut tau] = [0.0, 0.0];
        for _ in 0..12 {
            let at = self.accelerations([q1, q2], tau)?;
            let by_q1 = self.accelerations([q1 + 1e-6, q2], tau)?.map(|a| a * 1e6);
            let by_tau = self.accelerations([q1, q2], tau + 1.0)?;
            let [a, b] = [by_q1[0] - at[0] * 1e6, by_tau[0] - at[0]];
            let [c, d] = [by_q1[1] - at[1] * 1e6, by_tau[1] - at[1]];
            let determinant = a * d - b * c;
            q1 -= (d * at[0] - b * at[1]) / determinant;
            tau -= (a * at[1] - c * at[0]) / determinant;
        }
        Ok([q1, tau])
    }

    /// ∂q̈/∂q, by rows, and ∂q̈/∂τ, at an equilibrium.
    fn linearised(&mut self, q: [f64; 2], tau: f64) -> Result<([[f64; 2]; 2], [f64; 2]), Error> {
        let mut stiffness = [[0.0; 2]; 2];
        for link in [0, 1] {
            let column = slope(|step| {
                let mut moved = q;
                moved[link] += step;
                self.accelerations(moved, tau)
            })?;
            stiffness[0][link] = column[0];
            stiffness[1][link] = column[1];
        }
        let input = slope(|step| self.accelerations(q, tau + step))?;
        Ok((stiffness, input))
    }

    /// The controller's torque at a state, wanted at z.
    fn torque(&mut self, x: [f64; 4], z: f64) -> Result<f64, Error> {
        let [q1, q2, dq1, dq2] = x;
        let set = [("q1", q1), ("q2", q2), ("dq1", dq1), ("dq2", dq2), ("z_desired", z)];
        self.controller.start(0.0, &set)?;
        self.controller.get("tau")
    }

    /// ∂τ/∂x at an equilibrium.
    fn gains(&mut self, q: [f64; 2], z: f64) -> Result<[f64; 4], Error> {
        let mut gains = [0.0; 4];
        for (index, gain) in gains.iter_mut().enumerate() {
            let quotient = slope(|step| {
                let mut x = [q[0], q[1], 0.0, 0.0];
                x[index] += step;
                Ok([self.torque(x, z)?, 0.0])
            })?;
            *gain = quotient[0];
        }
        Ok(gains)
    }
}

/// The derivative at 0 by four points: its error is of the fourth order.
fn slope(mut of: impl FnMut(f64) -> Result<[f64; 2], Error>) -> Result<[f64; 2], Error> {
    let h = REACH;
    let [far_back, back, ahead, far_ahead] = [of(-2.0 * h)?, of(-h)?, of(h)?, of(2.0 * h)?];
    Ok([0, 1].map(|i| (far_back[i] - far_ahead[i] + 8.0 * (ahead[i] - back[i])) / (12.0 * h)))
}

/// What the units are at one place.
struct Place {
    q2: f64,
    /// q₁ and τ at which the plant stays.
    equilibrium: [f64; 2],
    z: f64,
    stiffness: [[f64; 2]; 2],
    /// s³, s², s, 1 of the closed loop's polynomial.
    polynomial: [f64; 4],
    /// The controller's torque there.
    torque: f64,
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let mut rig = Rig { plant: bench.unit("acrobot_plant")?, controller: bench.unit("acrobot_controller")? };
    let mut places = Vec::new();
    for step in -PLACES..=PLACES {
        let q2 = ARM_END * f64::from(step) / f64::from(PLACES);
        let [q1, tau] = rig.equilibrium(q2)?;
        let q = [q1, q2];
        let z = rig.z(q)?;
        let (stiffness, input) = rig.linearised(q, tau)?;
        let gains = rig.gains(q, z)?;
        places.push(Place {
            q2,
            equilibrium: [q1, tau],
            z,
            stiffness,
            polynomial: closed_loop(stiffness, input, gains),
            torque: rig.torque([q1, q2, 0.0, 0.0], z)?,
        });
    }
    let mut outcome = Outcome::default();
    outcome.claims.push(manifold(&mut rig, &places)?);
    outcome.claims.push(unstable(&mut rig, &places)?);
    outcome.claims.push(parameterization(&mut rig)?);
    outcome.claims.push(position_independent(&mut rig, &places)?);
    outcome.graph(
        figure(&places)?,
        "Figure 11: (13), and the equilibria of the plant unit (dots), which Newton's method finds on its accelerations.",
    )?;
    outcome.tables.push(("Along the manifold, measured on the units".to_owned(), table(&places)));
    Ok(outcome)
}

fn manifold(rig: &mut Rig, places: &[Place]) -> Result<Claim, Error> {
    let theta_10 = Theta::TABLE_2.theta_10;
    let off = places.iter().flat_map(|place| {
        let [q1, tau] = place.equilibrium;
        [q1 - lens::on_manifold(place.q2)[0], tau + theta_10 * libm::sin(place.q2)]
    });
    let off = off.map(f64::abs).fold(0.0, larger);
    let top = rig.equilibrium(std::f64::consts::FRAC_PI_2)?[0].abs();
    let end = places.last().map_or(f64::NAN, |place| place.equilibrium[0]);
    Ok(Claim::new(
        ["C10", "the manifold (13); q1 = f(q2) has no inverse", "Figure 11"],
        format!(
            "the plant's equilibria lie on (13) and τ = −1.880 sin q2 to {off:.0e}; abs(q1) is {top:.4} at q2 = π/2 and \
             {:.4} at 2.35, so it turns back",
            end.abs()
        ),
        "1e-6: how far the plant's accelerations tell the equilibrium",
        off <= 1e-6 && (top - 0.4043).abs() <= 1e-4 && (end + 0.2837).abs() <= 1e-4,
        "",
    ))
}

/// Eigenvalues λ² of ∂q̈/∂q as (real, imaginary) poles with Re ≥ 0.
fn poles(stiffness: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let [[a, b], [c, d]] = stiffness;
    let (half, determinant) = (0.5 * (a + d), a * d - b * c);
    let root = half * half - determinant;
    let pole = |re: f64, im: f64| {
        let size = f64::hypot(re, im);
        [f64::sqrt(0.5 * (size + re)), f64::sqrt(0.5 * (size - re))]
    };
    if root >= 0.0 {
        [pole(half + root.sqrt(), 0.0), pole(half - root.sqrt(), 0.0)]
    } else {
        let pole = pole(half, (-root).sqrt());
        [pole, pole]
    }
}

/// Both pairs of poles; each is real or imaginary where the eigenvalues of ∂q̈/∂q are real.
fn shown(poles: [[f64; 2]; 2], decimals: usize) -> String {
    let text = |[re, im]: [f64; 2]| match (re > 0.0, im > 0.0) {
        (true, true) => format!("±{re:.decimals$} ± {im:.decimals$}i"),
        (false, true) => format!("±{im:.decimals$}i"),
        _ => format!("±{re:.decimals$}"),
    };
    poles.map(text).join(", ")
}

fn unstable(rig: &mut Rig, places: &[Place]) -> Result<Claim, Error> {
    let growth = |stiffness| poles(stiffness).into_iter().map(|[re, _]| re).fold(0.0, larger);
    let slowest = places.iter().map(|place| growth(place.stiffness)).fold(f64::INFINITY, f64::min);
    let half = q2_of_half(rig)?;
    let mut at = |q2: f64| -> Result<[[f64; 2]; 2], Error> {
        let [q1, tau] = rig.equilibrium(q2)?;
        Ok(poles(rig.linearised([q1, q2], tau)?.0))
    };
    let (upright, middle, end) = (at(0.0)?, at(half)?, at(ARM_END)?);
    let seen = [upright[0], upright[1], middle[0], middle[1], end[0], end[1]];
    let other = [[7.28, 0.0], [3.25, 0.0], [4.35, 0.0], [0.0, 1.79], [4.73, 0.0], [0.0, 3.75]];
    let off = seen.iter().zip(&other).flat_map(|(ours, other)| [ours[0] - other[0], ours[1] - other[1]]);
    let off = off.map(f64::abs).fold(0.0, larger);
    Ok(Claim::new(
        ["C11", "every equilibrium of the manifold is unstable", "yes"],
        format!(
            "open-loop poles {} at z = 0; {} at z = 0.5; {} at q2 = 2.35; the largest real part is nowhere below \
             {slowest:.2} 1/s",
            shown(upright, 2),
            shown(middle, 2),
            shown(end, 2)
        ),
        "0.01 1/s against an independent implementation's poles: the digits it gives",
        slowest > 0.0 && off <= 0.01,
        "",
    ))
}

/// q₂ at which the plant says z = 0.5.
fn q2_of_half(rig: &mut Rig) -> Result<f64, Error> {
    let (mut low, mut high) = (0.0, ARM_END);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if rig.z(lens::on_manifold(middle))? < 0.5 { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

/// Length of the manifold in (q₁, q₂) from the upright.
fn arc(q2: f64) -> f64 {
    const PARTS: i32 = 4000;
    let point = |part: i32| lens::on_manifold(q2 * f64::from(part) / f64::from(PARTS));
    let chord = |part: i32| {
        let (from, to) = (point(part), point(part + 1));
        f64::hypot(to[0] - from[0], to[1] - from[1])
    };
    (0..PARTS).map(chord).sum()
}

fn parameterization(rig: &mut Rig) -> Result<Claim, Error> {
    let half = q2_of_half(rig)?;
    let end = rig.z(lens::on_manifold(ARM_END))?;
    let share = arc(half) / arc(ARM_END);
    Ok(Claim::new(
        ["C12", "z = 0.5 lies at this share of an arm's length", "about 75 %"],
        format!(
            "{:.2} % (q2 = {half:.4}); z = {end:.4} at the end, of which 0.5 is {:.1} %",
            100.0 * share,
            50.0 / end
        ),
        "1 %",
        (share - 0.75).abs() <= 0.01,
        "by scaling: the paper's z is that of its reference [27], which is not available. That z is nearly proportional \
         to the length besides is no choice",
    ).definition())
}

/// s³, s², s, 1 of det(sI − A − bk), by Faddeev and LeVerrier.
fn closed_loop(stiffness: [[f64; 2]; 2], input: [f64; 2], gains: [f64; 4]) -> [f64; 4] {
    let mut a = [[0.0; 4]; 4];
    (a[0][2], a[1][3]) = (1.0, 1.0);
    for row in [0, 1] {
        a[row + 2][..2].copy_from_slice(&stiffness[row]);
        for (entry, gain) in a[row + 2].iter_mut().zip(gains) {
            *entry += input[row] * gain;
        }
    }
    let times = |m: &[[f64; 4]; 4]| {
        let mut product = [[0.0; 4]; 4];
        for (row, line) in product.iter_mut().enumerate() {
            for (column, entry) in line.iter_mut().enumerate() {
                *entry = (0..4).map(|k| a[row][k] * m[k][column]).sum();
            }
        }
        product
    };
    let mut m = [[0.0; 4]; 4];
    let mut previous = 1.0;
    let mut coefficients = [0.0; 4];
    for (order, coefficient) in (1..).zip(&mut coefficients) {
        m = times(&m);
        for (index, row) in m.iter_mut().enumerate() {
            row[index] += previous;
        }
        let product = times(&m);
        let trace: f64 = (0..4).map(|index| product[index][index]).sum();
        *coefficient = -trace / f64::from(order);
        previous = *coefficient;
    }
    coefficients
}

fn position_independent(rig: &mut Rig, places: &[Place]) -> Result<Claim, Error> {
    rig.controller.start(0.0, &[])?;
    let mut pair = |omega: &str, zeta: &str| -> Result<[f64; 2], Error> {
        let (omega, zeta) = (rig.controller.get(omega)?, rig.controller.get(zeta)?);
        Ok([2.0 * zeta * omega, omega * omega])
    };
    let ([d1, w1], [d2, w2]) = (pair("omega_1", "zeta_1")?, pair("omega_2", "zeta_2")?);
    let wanted = [d1 + d2, w1 + w2 + d1 * d2, d1 * w2 + d2 * w1, w1 * w2];
    let off = places.iter().flat_map(|place| {
        place.polynomial.into_iter().zip(wanted).map(|(ours, wanted)| (ours / wanted - 1.0).abs())
    });
    let off = off.fold(0.0, larger);
    let torque = places.iter().map(|place| (place.torque - place.equilibrium[1]).abs()).fold(0.0, larger);
    Ok(Claim::new(
        ["C13", "the pseudolinearized loop's linearisation doesn't depend on the place", "qualitative"],
        format!(
            "its polynomial's coefficients are those of the chosen poles to {off:.0e} of their size at {} places; the \
             controller's torque holds the plant at rest to {torque:.0e} N·m",
            places.len()
        ),
        "1e-4: what an independent implementation keeps; the difference quotients are good to about 1e-8",
        off <= 1e-4 && torque <= 1e-6,
        "the law is our own, the paper's reference [27] being unavailable",
    ))
}

fn figure(places: &[Place]) -> Result<Graph, Error> {
    let curve = lens::places().into_iter().map(|q2| (q2, lens::on_manifold(q2)[0])).collect();
    let dots = places.iter().map(|place| (place.q2, place.equilibrium[0])).collect();
    let graph = Graph::new(
        "Equilibrium manifold",
        Axis::over("q₂ in rad", -2.5, 2.5),
        Axis::over("q₁ in rad", -0.5, 0.5),
    )
    .with(Line::solid("(13)", curve))
    .with(Line::dots("the plant's equilibria", dots));
    Ok(graph)
}

fn table(places: &[Place]) -> Table {
    let head = ["q₂", "q₁", "τ in N·m", "z", "open-loop poles, 1/s", "closed loop: s³, s², s, 1"];
    let upper = places.iter().filter(|place| place.q2 >= 0.0).step_by(3);
    let rows = upper.map(|place| {
        let coefficients: Vec<String> = place.polynomial.iter().map(|value| format!("{value:.4}")).collect();
        vec![
            Cell::Number(format!("{:.4}", place.q2)),
            Cell::Number(format!("{:.4}", place.equilibrium[0])),
            Cell::Number(format!("{:.4}", place.equilibrium[1])),
            Cell::Number(format!("{:.4}", place.z)),
            shown(poles(place.stiffness), 3).into(),
            coefficients.join(", ").into(),
        ]
    });
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}
