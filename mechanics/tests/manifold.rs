//! Eq. (13), the linearisation along the manifold, and z.

use mechanics::{Linearisation, MechanicsError, Place, Theta};

const PINNED: Theta = Theta { theta_2: 0.0, theta_7: 0.0, ..Theta::TABLE_2 };
const OTHER: Theta = Theta { theta_1: 0.3, theta_5: 0.06, theta_8: 0.07, theta_10: 3.1, ..Theta::TABLE_2 };

fn times(a: &[[f64; 4]; 4], v: [f64; 4]) -> [f64; 4] {
    a.map(|row| row.iter().zip(v).map(|(x, y)| x * y).sum())
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Squares of the open-loop poles: the eigenvalues of K.
fn pole_squares(theta: &Theta, q2: f64) -> [f64; 2] {
    let [[a, b], [c, d]] = theta.linearisation(q2).unwrap().stiffness;
    let (half, root) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * c).sqrt());
    [half + root, half - root]
}

#[test]
fn paper_c10_manifold_of_figure_11() {
    let theta = Theta::TABLE_2;
    // C10 (docs/claims.md) gives four digits; the rest by Python: arcsin(1.88/4.779*sin(q2)), CPython 3 math.
    for (q2, q1) in
        [(std::f64::consts::FRAC_PI_2, -0.404_313_537_245_875_8), (2.35, -0.283_674_208_092_347_67)]
    {
        assert!((theta.manifold_q1(q2).unwrap() - q1).abs() < 1e-15); // rounding of an arcsine
        assert_eq!(theta.manifold_q1(-q2).unwrap(), -theta.manifold_q1(q2).unwrap());
    }
    let steepest = (0..=2350).map(|k| theta.manifold_q1(k as f64 * 1e-3).unwrap().abs()).fold(0.0, f64::max);
    assert!((steepest - 0.4043).abs() < 1e-4); // digits of C10
    assert!((theta.manifold_torque(0.7) + 1.880 * 0.7_f64.sin()).abs() < 1e-15);
}

#[test]
fn paper_c11_open_loop_poles() {
    // C11: +-7.28, +-3.25 at z = 0; +-4.35, +-1.79i at z = 0.5; +-4.73, +-3.75i at 2.35. Tolerance 1e-2.
    for (q2, real, other) in [(0.0, 7.28, 3.25), (1.7559, 4.35, -1.79), (2.35, 4.73, -3.75)] {
        let [fast, slow] = pole_squares(&Theta::TABLE_2, q2);
        assert!((fast.sqrt() - real).abs() < 1e-2, "{fast}");
        assert!((slow.abs().sqrt() * slow.signum() - other).abs() < 1e-2, "{slow}");
    }
}

#[test]
fn paper_c12_z_is_half_at_three_quarters() {
    let place = Place::new(&Theta::TABLE_2).unwrap();
    assert!((place.z(1.7559) - 0.5).abs() < 1e-4); // docs/claims.md: q2(0.5) = 1.7559
    assert!((place.z(2.35) - 0.6586).abs() < 1e-4);
    assert!((1.0 / place.slope(0.0) - 5.5).abs() < 0.05); // dq2/dz as docs/claims.md rounds it
    assert!((1.0 / place.slope(1.7559) - 3.2).abs() < 0.05);
}

#[test]
fn value_z_by_quadpack() {
    // scipy 1.17.1: quad of n.x_e' with n from numpy.linalg.inv(M), brentq for 75 % of the arc.
    let expected = [
        (Theta::TABLE_2, -54.107_445_944_998_9, 0.658_579_920_029_607_2, 5.503_683_817_489_405),
        (PINNED, -68.539_045_358_773_63, 0.655_275_112_575_431, 5.514_872_101_988_304_5),
    ];
    for (theta, scale, z_end, upright) in expected {
        let place = Place::new(&theta).unwrap();
        // quad and brentq answer to about 1e-13; the table's own error is below that.
        assert!((place.scale() / scale - 1.0).abs() < 1e-12, "{}", place.scale());
        assert!((place.z(2.35) - z_end).abs() < 1e-12, "{}", place.z(2.35));
        assert!((1.0 / place.slope(0.0) - upright).abs() < 1e-11);
        assert!((place.z(1.755_878_915_127_512_3) - 0.5).abs() < 1e-11); // between nodes: the table's stated error
    }
}

#[test]
fn law_n_is_the_last_row_of_the_inverse() {
    for theta in [Theta::TABLE_2, PINNED, OTHER] {
        for q2 in [-2.3, -0.8, 0.0, 0.4, 1.2, 1.7, 2.6] {
            let point = theta.linearisation(q2).unwrap();
            let (n, a) = (point.n().unwrap(), point.a());
            let mut column = point.b();
            for (power, expected) in [0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
                let rows = point.controllability();
                for i in 0..4 {
                    assert!((rows[i][power] - column[i]).abs() <= 1e-12 * column[i].abs()); // rounding of A³b
                }
                assert!((dot(n, column) - expected).abs() < 1e-13, "q2 = {q2}, A^{power} b");
                column = times(&a, column);
            }
        }
    }
}

#[test]
fn law_equilibria_stay_and_the_manifold_is_tangent() {
    let h = 1e-4; // differences of fourth order: error h⁴ = 1e-16 times derivatives of order one
    for theta in [Theta::TABLE_2, PINNED, OTHER] {
        for q2 in [-2.0, -0.3, 0.0, 0.9, 2.35] {
            let q1 = theta.manifold_q1(q2).unwrap();
            let mut equation = theta.equation([q1, q2], [0.0; 2], None, true);
            equation.add_joint_torque(theta.manifold_torque(q2));
            assert!(equation.accelerations().iter().all(|ddq| ddq.abs() < 1e-13)); // rounding of forces of 5 N·m

            let slope_by_difference = |f: &dyn Fn(f64) -> f64| {
                (8.0 * (f(q2 + h) - f(q2 - h)) - (f(q2 + 2.0 * h) - f(q2 - 2.0 * h))) / (12.0 * h)
            };
            let slope = theta.manifold_slope(q2).unwrap();
            assert!((slope - slope_by_difference(&|q2| theta.manifold_q1(q2).unwrap())).abs() < 1e-10);
            // A·x_e′ + b·τ_e′ = 0
            let point = theta.linearisation(q2).unwrap();
            let along = times(&point.a(), [slope, 1.0, 0.0, 0.0]);
            let torque_slope = -theta.theta_10 * q2.cos();
            for (a, b) in along.iter().zip(point.b()) {
                assert!((a + b * torque_slope).abs() < 1e-12);
            }
            // dz/dq₂ = c·n·x_e′, between the table's nodes too.
            let place = Place::new(&theta).unwrap();
            let expected = place.scale() * dot(point.n().unwrap(), [slope, 1.0, 0.0, 0.0]);
            assert!((place.slope(q2) - expected).abs() < 1e-8, "{} {expected}", place.slope(q2)); // cubic: h³
        }
    }
}

#[test]
fn law_z_is_odd_grows_and_has_an_inverse() {
    for theta in [Theta::TABLE_2, PINNED, OTHER] {
        let place = Place::new(&theta).unwrap();
        assert_eq!(place.z(0.0).to_bits(), 0.0_f64.to_bits());
        assert!((place.end() - 2.6018).abs() < 1e-4);
        let mut last = -1.0;
        for k in 0..=2600 {
            let q2 = k as f64 * 1e-3;
            let z = place.z(q2);
            assert!(z > last);
            assert_eq!(place.z(-q2), -z);
            assert!((place.q2(z) - q2).abs() < 1e-12); // rounding of z over the slope
            assert_eq!(place.q2(-z), -place.q2(z));
            last = z;
        }
        assert_eq!(place.z(3.0), place.z(place.end()));
        assert_eq!(place.slope(3.0), 0.0);
        assert!((place.slope(place.end()) - place.slope(place.end() - 1e-9)).abs() < 1e-8); // d²z/dq₂² is below 10
        assert_eq!(place.q2(9.0), place.end());
    }
}

#[test]
fn every_impossible_theta_is_refused_with_the_place() {
    let steep = Theta { theta_10: 5.0, ..Theta::TABLE_2 };
    assert_eq!(Place::new(&steep), Err(MechanicsError::NoManifold { ratio: 5.0 / 4.779 }));
    let level = Theta { theta_10: 4.779, ..Theta::TABLE_2 }; // the manifold would end at q2 = pi/2
    assert_eq!(Place::new(&level), Err(MechanicsError::NoManifold { ratio: 1.0 }));
    let weightless = Theta { theta_9: 0.0, theta_10: 0.0, ..Theta::TABLE_2 };
    assert!(matches!(weightless.manifold_q1(0.3), Err(MechanicsError::NoManifold { .. })));
    // M of three equal entries is semi-definite: it can't be inverted either.
    let equal = Theta { theta_1: 0.11, theta_2: 0.0, theta_7: 0.0, theta_8: 0.11, ..Theta::TABLE_2 };
    let flat = MechanicsError::SingularInertia { q1: 0.0, q2: 0.0, determinant: 0.0 };
    assert_eq!(Place::new(&equal), Err(flat));
    let light = Theta { theta_5: 0.01, ..Theta::TABLE_2 };
    assert!(matches!(Place::new(&light), Err(MechanicsError::SingularInertia { q1: 0.0, q2: 0.0, .. })));
    // Without coupling the poles of the links are θ₉/θ₁ and θ₁₀/θ₅; equal ones can't be moved apart.
    let twins =
        Theta { theta_2: 0.0, theta_7: 0.0, theta_8: 0.0, theta_1: 0.4779, theta_5: 0.188, ..Theta::TABLE_2 };
    let point = twins.linearisation(0.0).unwrap();
    assert_eq!(point.p(), Err(MechanicsError::Uncontrollable { q2: 0.0 }));
    assert!(point.p().unwrap_err().to_string().contains("q2 = 0 rad"));
    assert!(Place::new(&twins).is_ok()); // z needs no controllability
}

#[test]
fn every_rounded_determinant_counts_as_not_controllable() {
    // For K = diag(k, 1) the determinant is b₁·b₂·(k − 1), and its two terms are b₁·b₂·k and b₁·b₂: a share of 1e-10 of
    // their sum is the limit, 2e-10 in k, whatever the size of b.
    for b in [1e-6, 1.0, 1e6] {
        let apart =
            |by: f64| Linearisation { q2: 0.3, stiffness: [[1.0 + by, 0.0], [0.0, 1.0]], input: [b, b] };
        assert!(apart(2.5e-10).p().is_ok(), "b = {b}");
        for by in [0.0, 1.5e-10, -1.5e-10] {
            assert_eq!(apart(by).p(), Err(MechanicsError::Uncontrollable { q2: 0.3 }), "b = {b}, {by}");
        }
    }
    let unmoved = Linearisation { q2: 0.3, stiffness: [[2.0, 0.0], [0.0, 1.0]], input: [0.0, 0.0] };
    assert_eq!(unmoved.p(), Err(MechanicsError::Uncontrollable { q2: 0.3 }));
}
