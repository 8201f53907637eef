//! Pseudolinearization: the tables against the formulas, and the closed loop's polynomial along the manifold.

use controller::{
    law::{self, Polynomial},
    schedule::Schedule,
    spline::Spline,
};
use mechanics::{MechanicsError, Place, Theta};

const PINNED: Theta = Theta { theta_2: 0.0, theta_7: 0.0, ..Theta::TABLE_2 };
const OTHER: Theta = Theta { theta_1: 0.24, theta_5: 0.1, theta_8: 0.09, theta_10: 2.1, ..Theta::TABLE_2 };
/// The three pole sets of docs/claims.md.
const PRESETS: [[f64; 4]; 3] = [[6.11, 0.84, 3.52, 0.54], [4.02, 1.03, 2.76, 0.35], [4.51, 0.98, 2.96, 0.20]];

/// Coefficients a₀..a₃ of the characteristic polynomial, by Faddeev and LeVerrier.
fn characteristic(a: &[[f64; 4]; 4]) -> [f64; 4] {
    let mut m = [[0.0; 4]; 4];
    let mut coefficients = [0.0; 5];
    coefficients[4] = 1.0;
    for k in 1..=4 {
        let mut next = [[0.0; 4]; 4];
        for (i, row) in next.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = (0..4).map(|l| a[i][l] * m[l][j]).sum();
            }
            row[i] += coefficients[5 - k];
        }
        m = next;
        let trace: f64 = (0..4).map(|i| (0..4).map(|l| a[i][l] * m[l][i]).sum::<f64>()).sum();
        coefficients[4 - k] = -trace / k as f64;
    }
    [coefficients[0], coefficients[1], coefficients[2], coefficients[3]]
}

/// The closed loop linearised numerically at an equilibrium; nothing of the design enters but the law itself.
fn closed_loop(
    theta: &Theta,
    schedule: &Schedule,
    polynomial: &Polynomial,
    q2: f64,
    terms: bool,
) -> [[f64; 4]; 4] {
    let z = Place::new(theta).unwrap().z(q2);
    let equilibrium = [theta.manifold_q1(q2).unwrap(), q2, 0.0, 0.0];
    let rates = |x: [f64; 4]| {
        let (q, dq) = ([x[0], x[1]], [x[2], x[3]]);
        let mut equation = theta.equation(q, dq, None, terms);
        equation.add_joint_torque(law::torque(schedule, polynomial, q, dq, z).torque);
        let [ddq1, ddq2] = equation.accelerations();
        [dq[0], dq[1], ddq1, ddq2]
    };
    let h = 5e-4; // fourth order: error of the order h⁴ = 6e-14 times fifth derivatives, and rounding 1e-13/h
    let mut a = [[0.0; 4]; 4];
    for j in 0..4 {
        let at = |multiple: f64| {
            let mut x = equilibrium;
            x[j] += multiple * h;
            rates(x)
        };
        let [far_before, before, after, far_after] = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
        for i in 0..4 {
            a[i][j] = (8.0 * (after[i] - before[i]) - (far_after[i] - far_before[i])) / (12.0 * h);
        }
    }
    a
}

#[test]
fn paper_c13_polynomial_is_the_same_everywhere() {
    let mut worst: f64 = 0.0;
    for theta in [Theta::TABLE_2, PINNED, OTHER] {
        let schedule = Schedule::new(&theta).unwrap();
        for [omega_1, zeta_1, omega_2, zeta_2] in PRESETS {
            let polynomial = Polynomial::from_pole_pairs([omega_1, zeta_1], [omega_2, zeta_2]);
            for k in -47..=47 {
                let q2 = 0.05 * f64::from(k); // to 2.35 either way, between the knots
                for terms in [true, false] {
                    let found = characteristic(&closed_loop(&theta, &schedule, &polynomial, q2, terms));
                    for (found, expected) in found.into_iter().zip(polynomial.a) {
                        let error = (found / expected - 1.0).abs();
                        worst = worst.max(error);
                        // C13: equal everywhere to 2e-8.
                        assert!(error < 2e-8, "q2 = {q2}: {found} instead of {expected}");
                    }
                }
            }
        }
    }
    println!("largest relative deviation {worst:e}");
}

#[test]
fn value_polynomial_of_the_pole_pairs() {
    // numpy.poly of the roots of s² + 2·0.84·6.11 s + 6.11² and s² + 2·0.54·3.52 s + 3.52².
    let expected = [462.5596518400006, 269.1066892800003, 88.74516368000008, 14.066400000000005];
    let polynomial = Polynomial::from_pole_pairs([6.11, 0.84], [3.52, 0.54]);
    for (found, expected) in polynomial.a.into_iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-13); // rounding
    }
}

#[test]
fn law_tables_are_within_their_stated_error() {
    for theta in [Theta::TABLE_2, PINNED, OTHER] {
        let (schedule, place) = (Schedule::new(&theta).unwrap(), Place::new(&theta).unwrap());
        let exact = |q2: f64| {
            let point = theta.linearisation(q2).unwrap();
            let p = point.p().unwrap();
            let pk = point.times_stiffness(p);
            let pkk = point.times_stiffness(pk);
            let c = place.scale();
            [
                theta.manifold_q1(q2).unwrap(),
                place.z(q2),
                c * p[0],
                c * p[1],
                c * pk[0],
                c * pk[1],
                pkk[0],
                pkk[1],
            ]
        };
        let table = |q2: f64| {
            let at = schedule.at(q2);
            [at.q1, at.z, at.cp[0], at.cp[1], at.cpk[0], at.cpk[1], at.pkk[0], at.pkk[1]]
        };
        let places: Vec<f64> = (0..=1000).map(|k| 2.6 * f64::from(k) / 1000.0).collect();
        for i in 0..8 {
            let largest = places.iter().map(|q2| exact(*q2)[i].abs()).fold(0.0, f64::max);
            let (mut off, mut slope_off) = (0.0_f64, 0.0_f64);
            for q2 in places.iter().copied() {
                off = off.max((table(q2)[i] - exact(q2)[i]).abs() / largest);
                let h = 1e-4; // central difference of second order: h²/6 cancels between table and formula
                if q2 > h && q2 < 2.6 - h {
                    let slope = |f: &dyn Fn(f64) -> [f64; 8]| (f(q2 + h)[i] - f(q2 - h)[i]) / (2.0 * h);
                    slope_off = slope_off.max((slope(&table) - slope(&exact)).abs() / largest);
                }
            }
            println!("{i}: {off:e} {slope_off:e}");
            assert!(off < 1e-11, "function {i}: {off:e}"); // schedule.rs
            assert!(slope_off < 1e-8, "function {i}: {slope_off:e}"); // schedule.rs
        }
    }
}

#[test]
fn law_splines_reproduce_polynomials_of_the_fifth_degree() {
    let f = |x: f64| [1.0 - x + 0.3 * x.powi(3) - 0.2 * x.powi(5), x.powi(4)];
    let knots: Vec<[f64; 2]> = (0..=12).map(|k| f(-1.0 + 0.25 * f64::from(k))).collect();
    let spline = Spline::through(-1.0, 0.25, &knots).unwrap();
    for k in -10..=310 {
        let x = 0.01 * f64::from(k) - 1.0; // a little outside the knots too
        for (found, expected) in spline.at(x).into_iter().zip(f(x)) {
            assert!((found - expected).abs() < 1e-11, "{x}: {found} {expected}"); // rounding times the solve's growth
        }
    }
    assert_eq!(Spline::through(0.0, 1.0, &[[0.0]; 8]), None);
}

#[test]
fn law_splines_converge_at_order_six_up_to_the_ends() {
    let error = |intervals: u32| {
        let spacing = 3.0 / f64::from(intervals);
        let knots: Vec<[f64; 1]> = (0..=intervals).map(|k| [(2.0 * spacing * f64::from(k)).sin()]).collect();
        let spline = Spline::through(0.0, spacing, &knots).unwrap();
        let off = |x: f64| (spline.at(x)[0] - (2.0 * x).sin()).abs();
        (0..=3000).map(|k| off(1e-3 * f64::from(k))).fold(0.0, f64::max)
    };
    let order = (error(20) / error(40)).log2();
    assert!((order - 6.0).abs() < 0.6, "{order}"); // 0.6: the ends' constant settles slowly
}

#[test]
fn law_equilibria_are_kept_and_mirror_images_answered_alike() {
    let (theta, schedule) = (Theta::TABLE_2, Schedule::new(&Theta::TABLE_2).unwrap());
    let polynomial = Polynomial::from_pole_pairs([6.11, 0.84], [3.52, 0.54]);
    let place = Place::new(&theta).unwrap();
    for k in -47..=47 {
        let q2 = 0.05 * f64::from(k);
        let answer =
            law::torque(&schedule, &polynomial, [theta.manifold_q1(q2).unwrap(), q2], [0.0; 2], place.z(q2));
        assert!((answer.torque - theta.manifold_torque(q2)).abs() < 1e-8); // the tables' 1e-11 times gains below 100
        assert!((answer.place - place.z(q2)).abs() < 1e-10);
        let here = law::torque(&schedule, &polynomial, [0.1, q2], [0.3, -0.2], 0.4);
        let mirrored = law::torque(&schedule, &polynomial, [-0.1, -q2], [-0.3, 0.2], -0.4);
        if q2 != 0.0 {
            assert_eq!((here.torque, here.place), (-mirrored.torque, -mirrored.place));
        }
    }
}

#[test]
fn law_goes_on_linearly_beyond_the_tables_end() {
    let schedule = Schedule::new(&Theta::TABLE_2).unwrap();
    assert!((schedule.end() - 2.6018).abs() < 1e-4);
    let polynomial = Polynomial::from_pole_pairs([6.11, 0.84], [3.52, 0.54]);
    let torque = |q2: f64| law::torque(&schedule, &polynomial, [-0.2, q2], [0.1, 0.2], 0.5).torque;
    let end = schedule.end();
    let slope = (torque(end + 0.2) - torque(end + 0.1)) / 0.1;
    assert!((torque(end + 0.4) - torque(end) - 0.4 * slope).abs() < 1e-10); // rounding
    assert_eq!(schedule.at(9.0), schedule.at(end));
}

#[test]
fn every_uncontrollable_place_is_named() {
    // Links without coupling: their poles θ₉cos q₁/θ₁ and θ₁₀cos q₂/θ₅ meet on the way.
    let theta =
        Theta { theta_2: 0.0, theta_7: 0.0, theta_8: 0.0, theta_1: 0.4, theta_5: 0.08, ..Theta::TABLE_2 };
    let error = Schedule::new(&theta).unwrap_err();
    let MechanicsError::Uncontrollable { q2 } = error else { panic!("{error}") };
    let gap = |q2: f64| theta.theta_9 * theta.manifold_q1(q2).unwrap().cos() / 0.4 - 1.880 * q2.cos() / 0.08;
    assert!(gap(q2) * gap(q2 - 0.011) <= 0.0, "{q2}"); // within one interval of the table
    // The same beyond the arm only shortens the table.
    let theta = Theta {
        theta_1: 0.4608,
        theta_2: 0.0,
        theta_5: 0.0375,
        theta_7: 0.0405,
        theta_8: 0.0705,
        theta_9: 4.779,
        theta_10: 0.896,
    };
    let end = Schedule::new(&theta).unwrap().end();
    assert!((2.39..2.5).contains(&end), "{end}"); // numpy: the determinant changes sign between 2.4 and 2.5
}

#[test]
fn law_slopes_are_the_differences_of_the_law() {
    for theta in [Theta::TABLE_2, PINNED, OTHER] {
        let schedule = Schedule::new(&theta).unwrap();
        let polynomial = Polynomial::from_pole_pairs([6.11, 0.84], [3.52, 0.54]);
        let end = schedule.end();
        for x in [
            [-0.1, 0.4, 0.3, -0.2, 0.1],
            [0.2, -1.3, -0.5, 0.4, -0.3],
            [0.0, 0.0, 0.0, 0.0, 0.0],
            [0.3, end + 0.1, 0.2, 0.1, 0.5],
        ] {
            let answer = |x: [f64; 5]| {
                let answer = law::torque(&schedule, &polynomial, [x[0], x[1]], [x[2], x[3]], x[4]);
                [answer.torque, answer.place]
            };
            let slopes = law::slopes(&schedule, &polynomial, [x[0], x[1]], [x[2], x[3]]);
            for known in 0..5 {
                // Fourth order: h⁴ = 1e-12 times fifth derivatives of splines, and rounding 1e-13/h.
                let h = 1e-3;
                let at = |multiple: f64| {
                    let mut moved = x;
                    moved[known] += multiple * h;
                    answer(moved)
                };
                let [far_before, before, after, far_after] = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
                for unknown in 0..2 {
                    let near = 8.0 * (after[unknown] - before[unknown]);
                    let expected = (near - (far_after[unknown] - far_before[unknown])) / (12.0 * h);
                    let found = slopes[unknown][known];
                    let scale = expected.abs().max(100.0);
                    assert!(
                        (found - expected).abs() < 1e-7 * scale,
                        "{unknown} by {known} at {x:?}: {found}, not {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn value_nine_knots_are_enough_for_a_spline() {
    let values: Vec<[f64; 1]> = (0..9).map(|knot| [f64::from(knot)]).collect();
    let spline = Spline::through(0.0, 1.0, &values).expect("as many as its conditions need");
    // A line is one of the polynomials that it holds.
    assert!((spline.at(3.5)[0] - 3.5).abs() < 1e-12);
    assert_eq!(Spline::through(0.0, 1.0, &values[1..]), None);
}

#[test]
fn law_the_table_stands_still_from_its_end_on() {
    let schedule = Schedule::new(&Theta::default()).expect("controllable");
    let end = schedule.end();
    for q2 in [end, -end, 3.0] {
        let slope = schedule.slope(q2);
        assert_eq!((slope.q2, slope.q1, slope.z, slope.torque, slope.cp), (0.0, 0.0, 0.0, 0.0, [0.0; 2]));
    }
    assert!(schedule.slope(end - 1e-9).z > 0.0);
    let h = 1e-5; // differences of a sine: good to h² and to 1e-16/h
    let difference = (schedule.at(1.1 + h).torque - schedule.at(1.1 - h).torque) / (2.0 * h);
    assert!((schedule.slope(1.1).torque - difference).abs() < 1e-9);
    // What is written at the upright is 0, not -0.
    assert_eq!(schedule.at(0.0).q2.to_bits(), 0);
}
