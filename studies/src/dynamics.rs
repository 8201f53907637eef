//! Tables 1 and 2 and eq. (12): what the plant unit does with the dynamic parameters, against the Lagrangian.

use crate::unit::Unit;
use crate::walk::larger;
use crate::{Bench, Claim, Error, Outcome, Study};
use mechanics::{Links, Theta};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "tables-1-2",
    title: "Tables 1 and 2: the dynamic parameters",
    claims: &["C8", "C9", "T1", "T2"],
    run,
};

/// A robot that could be built: Table 1 is evaluated for it.
const ROBOT: Links = Links {
    m1: 0.9,
    m2: 0.6,
    l1: 0.45,
    lc1: 0.2,
    lc2: 0.25,
    j1: 0.06,
    j2: 0.055,
    radius: 0.07,
    gravity: 9.81,
};

/// (q₁, q₂, q̇₁, q̇₂, τ): nothing special.
const STATES: [[f64; 5]; 5] = [
    [0.3, -0.7, 1.1, -0.4, 0.2],
    [-0.4, 1.9, -2.0, 3.0, -1.0],
    [0.05, 0.1, 0.0, 0.0, 0.7],
    [1.0, 2.2, 0.5, 1.5, 0.0],
    [-0.2, -1.4, 4.0, -2.5, 1.5],
];

/// theta by the names of the unit's parameters.
pub(crate) fn named(theta: &Theta) -> [(&'static str, f64); 7] {
    [
        ("theta_1", theta.theta_1),
        ("theta_2", theta.theta_2),
        ("theta_5", theta.theta_5),
        ("theta_7", theta.theta_7),
        ("theta_8", theta.theta_8),
        ("theta_9", theta.theta_9),
        ("theta_10", theta.theta_10),
    ]
}

/// Starts the plant in a state.
fn start(plant: &mut Unit, [q1, q2, dq1, dq2, tau]: [f64; 5], set: &[(&str, f64)]) -> Result<(), Error> {
    let state = [("q1_0", q1), ("q2_0", q2), ("dq1_0", dq1), ("dq2_0", dq2), ("tau", tau)];
    let set: Vec<_> = state.into_iter().chain(set.iter().copied()).collect();
    plant.start(0.0, &set)
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let mut plant = bench.unit("acrobot_plant")?;
    let mut outcome = Outcome::default();
    outcome.claims.push(definitions(&mut plant)?);
    let declared = declared(&mut plant, &mut bench.unit("acrobot_controller")?)?;
    outcome.claims.push(declared);
    outcome.claims.push(lagrangian(&mut plant)?);
    let (claim, table) = consistency();
    outcome.claims.push(claim);
    outcome.tables.push(("Lengths over gravity that Table 2 implies by Table 1".to_owned(), table));
    outcome.tables.push(("Tables 1 and 2: the parameters as both units have them".to_owned(), parameters()));
    Ok(outcome)
}

/// Table 1: definition and type.
const DEFINITIONS: [[&str; 2]; 7] = [
    ["m₁R² + m₂l₁² + m₂R² + J₁", "inertial"],
    ["2m₁R·l_c1 + 2m₂R·l₁", "inertial"],
    ["J₂", "inertial"],
    ["m₂R·l_c2", "inertial"],
    ["m₂l₁l_c2", "inertial"],
    ["m₁g·l_c1 + m₂g·l₁", "gravity"],
    ["m₂g·l_c2", "gravity"],
];

/// Table 1 with Table 2's values, and with those of the robot for which Table 1 is checked.
fn parameters() -> Table {
    let robot = named(&ROBOT.theta());
    let rows = named(&Theta::TABLE_2).into_iter().zip(robot).zip(DEFINITIONS).map(
        |((paper, robot), [definition, kind])| {
            let unit = if kind == "inertial" { "kg·m²" } else { "N·m" };
            vec![
                format!("`{}`", paper.0).into(),
                definition.into(),
                kind.into(),
                Cell::Number(format!("{} {unit}", paper.1)),
                Cell::Number(format!("{:.5} {unit}", robot.1)),
            ]
        },
    );
    let head = ["name", "definition (Table 1)", "type", "value (Table 2)", "by Table 1 for the robot of T1"];
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}

/// The energy of two bodies, from where they are and how they move.
fn energy(robot: &Links, [q1, q2, dq1, dq2, _]: [f64; 5]) -> f64 {
    let Links { m1, m2, l1, lc1, lc2, j1, j2, radius: r, gravity: g } = *robot;
    let ((s1, c1), (s2, c2)) = (libm::sincos(q1), libm::sincos(q2));
    // The drum's centre moves by R·dq1; J1 is about it, J2 about the joint.
    let square = |x: f64, y: f64| x * x + y * y;
    let body1 = square(r * dq1 + lc1 * c1 * dq1, -lc1 * s1 * dq1);
    let joint = (r * dq1 + l1 * c1 * dq1, -l1 * s1 * dq1);
    let body2 = square(joint.0 + lc2 * c2 * dq2, joint.1 - lc2 * s2 * dq2);
    let kinetic = 0.5 * m1 * body1
        + 0.5 * (j1 - m1 * lc1 * lc1) * dq1 * dq1
        + 0.5 * m2 * body2
        + 0.5 * (j2 - m2 * lc2 * lc2) * dq2 * dq2;
    kinetic + m1 * g * lc1 * c1 + m2 * g * (l1 * c1 + lc2 * c2)
}

fn definitions(plant: &mut Unit) -> Result<Claim, Error> {
    let mut off = 0.0;
    for state in STATES {
        start(plant, state, &named(&ROBOT.theta()))?;
        off = larger(off, (plant.get("energy")? - energy(&ROBOT, state)).abs());
    }
    Ok(Claim::new(
        ["T1", "Table 1: definitions of the dynamic parameters", "table"],
        format!("the plant's energy is that of two rigid bodies to {off:.0e} J in {} states", STATES.len()),
        "1e-12 J: rounding",
        off <= 1e-12,
        "J1 about the drum's centre and J2 about the joint, which the table doesn't say",
    )
    .part())
}

fn declared(plant: &mut Unit, controller: &mut Unit) -> Result<Claim, Error> {
    let mut same = 0;
    plant.start(0.0, &[])?;
    controller.start(0.0, &[])?;
    for (name, value) in named(&Theta::TABLE_2) {
        same += usize::from(plant.get(name)? == value && controller.get(name)? == value);
    }
    Ok(Claim::new(
        ["T2", "Table 2: values of the dynamic parameters", "seven values"],
        format!("{same} of 7 are the start values of plant and controller"),
        "exact",
        same == 7,
        "θ9 and θ10 are given in \"Nt\": N·m",
    )
    .definition())
}

/// M(q)·q̈ + c = u as printed, and with velocity terms nothing is gained or lost.
fn lagrangian(plant: &mut Unit) -> Result<Claim, Error> {
    let theta = Theta::TABLE_2;
    let mut residual = 0.0;
    for state in STATES {
        start(plant, state, &[("velocity_terms", 0.0)])?;
        let [q1, q2, _, _, tau] = state;
        let (a1, a2) = (plant.get("ddq1")?, plant.get("ddq2")?);
        let m11 = theta.theta_1 + theta.theta_2 * libm::cos(q1); // (12)
        let m12 = theta.theta_7 * libm::cos(q2) + theta.theta_8 * libm::cos(q1 - q2); // (12)
        let first = m11 * a1 + m12 * a2 - theta.theta_9 * libm::sin(q1) + tau; // (12)
        let second = m12 * a1 + theta.theta_5 * a2 - theta.theta_10 * libm::sin(q2) - tau; // (12)
        residual = larger(residual, first.abs().max(second.abs()));
    }
    let (mut full, mut printed) = (0.0, 0.0);
    for (terms, drift) in [(1.0, &mut full), (0.0, &mut printed)] {
        start(plant, [0.3, -0.7, 1.1, -0.4, 0.0], &[("velocity_terms", terms), ("q2_max", 100.0)])?;
        let before = plant.get("energy")?;
        for step in 0..300 {
            let time = |step: i32| f64::from(step) / 600.0;
            plant.step(time(step), time(step + 1) - time(step))?;
        }
        *drift = (plant.get("energy")? - before).abs();
    }
    Ok(Claim::new(
        ["C8", "M(q) and gravity of (12) are the Lagrangian of the rolling two-link robot", "(12)"],
        format!(
            "residual of (12) {residual:.0e} N·m; energy drifts by {full:.0e} J in 0.5 s of free fall with the velocity \
             terms, by {printed:.1e} J without"
        ),
        "1e-12 N·m: rounding; 1e-8 J: the integrator's own error",
        residual <= 1e-12 && full <= 1e-8,
        "the printed c(q, q̇) holds no velocity terms although it is written as a function of q̇; the plant has them unless \
         velocity_terms is false",
    ))
}

/// What Table 2 implies for R/g and R/l1.
fn consistency() -> (Claim, Table) {
    let Theta { theta_2, theta_7, theta_8, theta_9, theta_10, .. } = Theta::TABLE_2;
    // Table 1: θ2 = 2R(m1·lc1 + m2·l1) and θ9 = g(m1·lc1 + m2·l1); θ7 = R·m2·lc2 and θ10 = g·m2·lc2.
    let (by_link1, by_link2) = (theta_2 / (2.0 * theta_9), theta_7 / theta_10);
    let (ratio, geometry) = (theta_7 / theta_8, 1.0 / 6.19);
    let apart = by_link2 / by_link1 - 1.0;
    let claim = Claim::new(
        ["C9", "Table 2 is consistent with Table 1", "-"],
        format!(
            "R/g is {by_link1:.5} s² by θ2/(2θ9) and {by_link2:.5} s² by θ7/θ10, {:.0} % apart; R/l1 is {ratio:.4} by \
             θ7/θ8, {geometry:.4} by the lengths of Section 4",
            100.0 * apart
        ),
        "1 %: three digits are printed at least",
        apart.abs() <= 0.01 && (ratio / geometry - 1.0).abs() <= 0.01,
        "not met by any masses and lengths: the two ratios are quotients of printed numbers. Table 2 is used for the \
         dynamics, the lengths for the picture, and neither is derived from the other",
    );
    let number = |value: f64| Cell::Number(format!("{value:.5}"));
    let rows = vec![
        vec!["R/g in s²".into(), "θ2/(2θ9)".into(), number(by_link1)],
        vec!["R/g in s²".into(), "θ7/θ10".into(), number(by_link2)],
        vec!["l1/g in s²".into(), "θ8/θ10".into(), number(theta_8 / theta_10)],
        vec!["R/l1".into(), "θ7/θ8".into(), number(ratio)],
        vec!["R/l1".into(), "1.0/6.19 (Section 4)".into(), number(geometry)],
    ];
    (claim, Table { head: ["quantity", "from", "value"].map(str::to_owned).to_vec(), rows })
}
