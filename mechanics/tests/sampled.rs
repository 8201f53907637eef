//! The sampled closed loop against numpy, with delays of less and more than a period and both kinds of rates.

use mechanics::{Rates, Sampling, Theta};

#[test]
fn value_spectral_radii_by_numpy() {
    // q2, delay in periods of 1/30 s, radius with true rates and with first differences: tests/reference.py.
    let expected = [
        (0.0, 0.0, 0.961298309168, 0.959420110565),
        (0.0, 0.4, 0.960871735107, 1.016808225246),
        (0.0, 1.0, 1.103646029680, 1.164257396328),
        (0.0, 1.7, 1.214346370358, 1.245537730035),
        (0.0, 2.2, 1.253152328351, 1.272212953597),
        (0.5, 0.0, 0.961469307611, 0.959609135779),
        (0.5, 0.4, 0.961193104980, 1.005515523161),
        (0.5, 1.0, 1.088482300179, 1.151733995918),
        (0.5, 1.7, 1.199808121384, 1.232548998310),
        (0.5, 2.2, 1.238935542629, 1.259051206188),
        (1.7559, 0.0, 0.961916883647, 0.960115549877),
        (1.7559, 0.4, 0.962056706052, 0.986679720390),
        (1.7559, 1.0, 1.062588822659, 1.130846809596),
        (1.7559, 1.7, 1.175081337659, 1.210680177379),
        (1.7559, 2.2, 1.214650168462, 1.236696369269),
    ];
    let polynomial = [462.6, 509.5, 236.3, 14.07];
    for (q2, periods, with_true, with_differences) in expected {
        let at = Theta::TABLE_2.linearisation(q2).expect("Table 2 has a manifold");
        for (rates, radius) in [(Rates::True, with_true), (Rates::FirstDifference, with_differences)] {
            let sampling = Sampling { period: 1.0 / 30.0, delay: periods / 30.0, rates };
            let found = at.spectral_radius(polynomial, &sampling).expect("controllable");
            // Gelfand's formula leaves 1e-8; eigenvalues of a matrix that is not normal lose half of numpy's digits.
            assert!(
                (found - radius).abs() < 1e-7,
                "{rates:?} at q2 = {q2}, {periods} periods: {found}, {radius}"
            );
        }
    }
}
