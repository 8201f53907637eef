//! Eq. (12), the velocity terms, the incline and the energy against derivations of their own.

use mechanics::{Incline, Links, Theta};

/// States over all quadrants with rates of either sign.
const STATES: [([f64; 2], [f64; 2]); 5] = [
    ([0.0, 0.0], [1.0, -2.0]),
    ([0.4, -1.1], [2.0, 3.0]),
    ([-2.5, 0.7], [-1.5, 0.3]),
    ([3.0, 2.9], [0.1, -4.0]),
    ([-0.9, -2.2], [0.0, 5.0]),
];

const LINKS: Links =
    Links { m1: 0.7, m2: 0.4, l1: 0.6, lc1: 0.25, lc2: 0.35, j1: 0.09, j2: 0.08, radius: 0.1, gravity: 9.81 };

fn inclines() -> [Option<Incline>; 4] {
    [(0.0, 0.0), (0.3, 0.0), (-0.8, 0.4), (0.0, -0.2)]
        .map(|(alpha, iota)| Incline::new(alpha, iota, LINKS.theta_slope()))
}

/// Fourth-order central difference of `f` at 0.
fn difference(f: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-3; // error: h⁴/30 times a fifth derivative of order 1, and rounding 1e-16/h: both below 1e-12
    (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}

#[test]
fn law_velocity_terms_are_the_christoffel_symbols_of_m() {
    let theta = LINKS.theta();
    for ground in inclines() {
        for (q, dq) in STATES {
            let inertia = |q: [f64; 2]| {
                let equation = theta.equation(q, [0.0; 2], ground.as_ref(), false);
                [[equation.m11, equation.m12], [equation.m12, equation.m22]]
            };
            let derivative = |k: usize, i: usize, j: usize| {
                difference(|h| {
                    let mut moved = q;
                    moved[k] += h;
                    inertia(moved)[i][j]
                })
            };
            let mut expected = [0.0; 2];
            for (i, row) in expected.iter_mut().enumerate() {
                for j in 0..2 {
                    for k in 0..2 {
                        *row += (derivative(k, i, j) - 0.5 * derivative(i, j, k)) * dq[j] * dq[k];
                    }
                }
            }
            let with = theta.equation(q, dq, ground.as_ref(), true);
            let without = theta.equation(q, dq, ground.as_ref(), false);
            assert!((without.f1 - with.f1 - expected[0]).abs() < 1e-10, "{q:?} {dq:?}"); // see `difference`, × rates²
            assert!((without.f2 - with.f2 - expected[1]).abs() < 1e-10, "{q:?} {dq:?}");
        }
    }
}

#[test]
fn law_energy_is_that_of_rolling_bodies() {
    // Masses on their paths, with none of the formulas under test: checks Table 1, M(q) and the incline at once.
    let (theta, Links { m1, m2, l1, lc1, lc2, j1, j2, radius, gravity }) = (LINKS.theta(), LINKS);
    for (alpha, iota) in [(0.0_f64, 0.0), (0.3, 0.0), (-0.8, 0.4), (0.0, -0.2)] {
        let centres = |q: [f64; 2]| {
            let (q, alpha) = (q.map(|angle| angle + iota), alpha + iota); // against the vertical
            let rolled = radius * (q[0] - iota);
            let drum = [rolled * alpha.cos(), -rolled * alpha.sin()];
            let on = |from: [f64; 2], length: f64, angle: f64| {
                [from[0] + length * angle.sin(), from[1] + length * angle.cos()]
            };
            let joint = on(drum, l1, q[0]);
            [on(drum, lc1, q[0]), on(joint, lc2, q[1])]
        };
        let ground = Incline::new(alpha, iota, LINKS.theta_slope());
        for (q, dq) in STATES {
            let mut expected =
                0.5 * (j1 - m1 * lc1 * lc1) * dq[0] * dq[0] + 0.5 * (j2 - m2 * lc2 * lc2) * dq[1] * dq[1];
            for (link, mass) in [m1, m2].into_iter().enumerate() {
                let velocity = [0, 1]
                    .map(|axis| difference(|h| centres([q[0] + h * dq[0], q[1] + h * dq[1]])[link][axis]));
                expected += 0.5 * mass * (velocity[0] * velocity[0] + velocity[1] * velocity[1]);
                expected += mass * gravity * centres(q)[link][1];
            }
            let energy = theta.energy(q, dq, ground.as_ref());
            assert!((energy - expected).abs() < 1e-9, "{energy} {expected}"); // see `difference`, × rates⁵
        }
    }
}

#[test]
fn law_power_is_torque_times_rate() {
    let theta = LINKS.theta();
    for ground in inclines() {
        for (q, dq) in STATES {
            let (tau, tau_1) = (0.7, -0.4);
            let mut equation = theta.equation(q, dq, ground.as_ref(), true);
            equation.add_joint_torque(tau);
            equation.f1 += tau_1;
            let ddq = equation.accelerations();
            let power = difference(|h| {
                let moved = |v: [f64; 2], rate: [f64; 2]| [v[0] + h * rate[0], v[1] + h * rate[1]];
                theta.energy(moved(q, dq), moved(dq, ddq), ground.as_ref())
            });
            let expected = tau * (dq[1] - dq[0]) + tau_1 * dq[0];
            assert!((power - expected).abs() < 1e-7, "{power} {expected}"); // see `difference`, × accelerations⁵
        }
    }
}

#[test]
fn law_mirror_images_move_alike_to_the_bit() {
    for (q, dq) in STATES {
        let here = Theta::TABLE_2.equation(q, dq, None, true).accelerations();
        let mirrored = Theta::TABLE_2.equation(q.map(|x| -x), dq.map(|x| -x), None, true).accelerations();
        assert_eq!(here, mirrored.map(|x| -x));
    }
}

#[test]
fn alone_level_ground_has_no_incline() {
    assert_eq!(Incline::new(0.0, 0.0, 0.956), None);
    assert_eq!(Incline::new(-0.0, -0.0, 0.956), None);
}

#[test]
fn value_accelerations_by_numpy() {
    // scipy session of fmus/plant/tests/reference.py: acceleration(TABLE_2, (.4,-1.1), (2.,3.), 0.5, 0.25).
    let mut equation = Theta::TABLE_2.equation([0.4, -1.1], [2.0, 3.0], None, true);
    equation.add_joint_torque(0.5);
    equation.f1 += 0.25;
    let ddq = equation.accelerations();
    let expected = [2.925_117_637_207_902_6, -7.458_101_000_822_262];
    for i in 0..2 {
        assert!((ddq[i] - expected[i]).abs() < 1e-13 * expected[i].abs()); // rounding
    }
}
