//! Sections 3.2 and 4.1 of the paper from rendered frames; numbers of docs/claims.md beside each.

use crate::common::*;
use camera::Variables;

/// Poses along each arm of the manifold. The rms settle to 2 % at this number.
const POSES: usize = 800;

struct Errors {
    rms: (f64, f64),
    max: (f64, f64),
    lost: usize,
}

fn errors(variables: &Variables) -> Errors {
    let all = along_manifold(variables, POSES);
    let first = || all.iter().filter_map(|(_, error)| error.map(|error| error.0));
    let second = || all.iter().filter_map(|(_, error)| error.map(|error| error.1));
    Errors {
        rms: (rms(first()), rms(second())),
        max: (largest(first()), largest(second())),
        lost: all.iter().filter(|(_, error)| error.is_none()).count(),
    }
}

fn within(factor: f64, found: f64, expected: f64, what: &str) {
    assert!(
        found < expected * factor && found > expected / factor,
        "{what}: {found:.3e}, expected {expected:.3e}"
    );
}

#[test]
fn paper_c14_height_of_the_robot() {
    let out = still(&Variables::default(), 0.0, 0.0);
    // From the ground line (v = -0.8, 204.8 px below the centre) to the tip, of 512 px; C14: 70.45 %.
    let share = (out.v3_px + 204.8) / 512.0;
    assert!((share - 0.7045).abs() < 0.005, "{share}");
}

#[test]
fn paper_c17_c21_c22_c23_clean_defocused_and_noisy_frames() {
    // (sigma, N) and the rms that docs/claims.md gives (C17, C21 to C23), x1.5 both ways.
    for (sigma, passes, rms) in [
        (0.0, 0, (3.9e-4, 3.5e-4)),
        (0.0, 1, (5.4e-4, 6.2e-4)),
        (0.0, 2, (7.1e-4, 6.3e-4)),
        (15.0, 0, (4.5e-4, 4.0e-4)),
        (30.0, 0, (6.9e-4, 5.9e-4)),
        (15.0, 1, (6.7e-4, 6.4e-4)),
    ] {
        let variables = variables(|v| {
            v.effects.noise.deviation = sigma;
            v.effects.defocus.passes = passes;
        });
        let found = errors(&variables);
        println!(
            "sigma {sigma} N {passes}: rms {:.2e} {:.2e} max {:.2e} {:.2e}",
            found.rms.0, found.rms.1, found.max.0, found.max.1
        );
        assert_eq!(found.lost, 0);
        within(1.5, found.rms.0, rms.0, "q1");
        within(1.5, found.rms.1, rms.1, "q2");
        let most = if sigma == 0.0 && passes == 0 { 1.2e-3 * 1.5 } else { 2.3e-3 * 1.5 };
        assert!(found.max.0.max(found.max.1) < most, "{:?}", found.max);
    }
}

#[test]
fn paper_c22_low_contrast_and_false_blobs() {
    // Contrast 50 (150/100), sigma 15: false blobs everywhere, which N_min removes; rms 1.4e-3.
    let variables = variables(|v| {
        (v.scene.foreground, v.scene.background) = (150.0, 100.0);
        v.sensor.threshold = 100.0 + 50.0 * 0.75;
        v.effects.noise.deviation = 15.0;
    });
    let found = errors(&variables);
    println!("contrast 50: rms {:.2e} {:.2e}, lost {}", found.rms.0, found.rms.1, found.lost);
    within(2.0, found.rms.0.max(found.rms.1), 1.4e-3, "contrast 50");
}

#[test]
fn paper_c24_beta_shrinks_the_usable_region() {
    // At the nominal threshold beta <= 5.0 is usable for f = 2; below it the errors stay what they are.
    let usable = errors(&variables(|v| v.effects.sensitivity.exponent = 3.0));
    assert_eq!(usable.lost, 0);
    assert!(usable.rms.0 < 5.5e-4 && usable.rms.1 < 5.5e-4, "{:?}", usable.rms);
    assert!(errors(&variables(|v| v.effects.sensitivity.exponent = 6.0)).lost > 0);
}

#[test]
fn paper_c25_table_3_from_rendered_frames() {
    type Case = (&'static str, Change, (f64, f64), (f64, f64));
    let lenses: [Case; 5] = [
        ("k1", |v| v.effects.radial.cubic = 0.1, (0.2, 0.1), (0.210, 0.119)),
        ("p1", |v| v.effects.decentering.horizontal = 0.1, (0.8, 0.5), (0.789, 0.536)),
        ("p2", |v| v.effects.decentering.vertical = 0.1, (1.0, 0.8), (1.026, 0.818)),
        ("s1", |v| v.effects.thin_prism.horizontal = 0.1, (0.8, 0.5), (0.791, 0.535)),
        ("s2", |v| v.effects.thin_prism.vertical = 0.1, (0.3, 0.4), (0.274, 0.415)),
    ];
    for (name, lens, paper, independent) in lenses {
        let variables = variables(|v| {
            lens(v);
            // The paper tunes N_min and N_max for p2 and s2 too.
            (v.sensor.smallest_area, v.sensor.largest_area) = (20, 160);
        });
        let found = errors(&variables);
        let k = (10.0 * found.max.0, 10.0 * found.max.1);
        println!("{name}: {:.3} {:.3}", k.0, k.1);
        assert_eq!(found.lost, 0, "{name}");
        for (ours, paper, independent) in [(k.0, paper.0, independent.0), (k.1, paper.1, independent.1)] {
            assert_eq!(format!("{ours:.1}"), format!("{paper:.1}"), "{name}");
            // T3: +-.02 between implementations for rendered frames (a pixel more or less at the maximum).
            assert!((ours - independent).abs() < 0.02, "{name}: {ours} {independent}");
        }
    }
}

#[test]
fn paper_c26_symmetries_of_the_error_curves() {
    let lenses: [(&str, Change, f64); 5] = [
        ("p1", |v| v.effects.decentering.horizontal = 0.1, 1.0),
        ("s1", |v| v.effects.thin_prism.horizontal = 0.1, 1.0),
        ("k1", |v| v.effects.radial.cubic = 0.1, -1.0),
        ("p2", |v| v.effects.decentering.vertical = 0.1, -1.0),
        ("s2", |v| v.effects.thin_prism.vertical = 0.1, -1.0),
    ];
    for (name, lens, parity) in lenses {
        let variables = variables(|v| {
            lens(v);
            (v.sensor.smallest_area, v.sensor.largest_area) = (20, 160);
        });
        let all = along_manifold(&variables, 200);
        let scale = largest(
            all.iter().filter_map(|(_, error)| *error).map(|(first, second)| first.abs().max(second.abs())),
        );
        for ((_, left), (_, right)) in all.iter().zip(all.iter().rev()) {
            let (Some(left), Some(right)) = (left, right) else { panic!("{name}: lost") };
            let defect = (left.0 - parity * right.0).abs().max((left.1 - parity * right.1).abs());
            // C26: symmetric to 5 % of the largest; quantisation adds its own 1.2e-3, twice.
            assert!(defect < 0.05 * scale + 2.4e-3, "{name}: {defect}");
        }
    }
}

#[test]
fn paper_c31_negative_p2_and_s2() {
    for (lens, larger_within) in [(0, 1.27), (1, 1.57)] {
        let with = |value: f64| {
            let variables = variables(|v| {
                if lens == 0 {
                    v.effects.decentering.vertical = value
                } else {
                    v.effects.thin_prism.vertical = value
                }
                (v.sensor.smallest_area, v.sensor.largest_area) = (15, 200);
            });
            along_manifold(&variables, 100)
        };
        for ((q2, positive), (_, negative)) in with(0.1).into_iter().zip(with(-0.1)) {
            let (positive, negative) = (positive.expect("found"), negative.expect("found"));
            // C30, C31: q1 errors smaller everywhere; q2 errors larger inside, smaller at the ends (± 0.05 rad, and
            // nothing to compare where both vanish).
            assert!(negative.0.abs() < positive.0.abs() + 2e-3, "{q2}");
            if q2.abs() < larger_within - 0.15 {
                assert!(negative.1.abs() > positive.1.abs() - 2.5e-3, "{q2}: {positive:?} {negative:?}");
            } else if q2.abs() > larger_within + 0.15 {
                assert!(negative.1.abs() < positive.1.abs() + 2.5e-3, "{q2}: {positive:?} {negative:?}");
            }
        }
    }
}

#[test]
fn paper_c35_composite_effects() {
    let found = errors(&variables(|v| {
        v.effects.noise.deviation = 15.0;
        v.effects.defocus.passes = 2;
        v.effects.radial.cubic = 0.2;
        (v.effects.decentering.horizontal, v.effects.decentering.vertical) = (0.002, 0.002);
        (v.effects.thin_prism.horizontal, v.effects.thin_prism.vertical) = (0.02, 0.01);
    }));
    println!(
        "composite: max {:.4} {:.4} rms {:.4} {:.4}",
        found.max.0, found.max.1, found.rms.0, found.rms.1
    );
    assert_eq!(found.lost, 0);
    // C35: .0459/.0256, rms .030/.009, 5 %; noise moves the maximum of q2 by 1e-3 from seed to seed.
    assert!((found.max.0 - 0.0459).abs() < 0.0023 && (found.max.1 - 0.0256).abs() < 0.0023);
    assert!((found.rms.0 - 0.030).abs() < 0.0015 && (found.rms.1 - 0.009).abs() < 0.0005);
}

#[test]
fn paper_c18_a_blurred_frame_shows_mid_exposure() {
    // Along the manifold at 0.15 z/s, dq2/dz about 5 near the upright: 0.7 rad/s, E_t = 1.
    let mut variables = variables(|v| v.sensor.exposure_factor = 1.0);
    let speed = 0.7;
    let pose = |t: f64| {
        let q2 = speed * t;
        let dq1 = -1.880 / 4.779 * q2.cos() * speed / manifold(q2).cos();
        [manifold(q2), q2, dq1, speed]
    };
    variables.inputs.link2_rate = speed;
    variables.inputs.link1_rate = pose(0.0)[2];
    let mut camera = started(&mut variables);
    let (mut errors, mut to_end) = (Vec::new(), Vec::new());
    for i in 0..1200 {
        let (from, to) = (f64::from(i) / 600.0, f64::from(i + 1) / 600.0);
        let before = variables.outputs.frame;
        step_to(&mut camera, &mut variables, from, to, pose(to));
        let out = &variables.outputs;
        if out.frame != before && out.valid {
            let middle = pose(out.mid_exposure);
            errors.push(out.link2_angle - middle[1]);
            to_end.push(out.link2_angle - pose(to)[1]);
        }
    }
    assert!(errors.len() >= 55, "{}", errors.len());
    // C18: quantisation only (4e-4/5e-4) to the middle; to the end half a period of motion.
    let (found, bias) = (rms(errors.iter().copied()), to_end.iter().sum::<f64>() / to_end.len() as f64);
    println!("to mid-exposure {found:.2e}, to the end {bias:.4}");
    assert!(found < 1e-3, "{found}");
    assert!((bias + speed / 60.0).abs() < 5e-4, "{bias}");
}

/// Frames lost on the way from the upright to z = 0.5 at a speed along z, E_t = 1, 30 Hz.
fn lost_at(z_rate: f64, smallest_area: i32) -> usize {
    let mut variables = variables(|v| {
        v.sensor.exposure_factor = 1.0;
        v.sensor.smallest_area = smallest_area;
    });
    // dq2/dz = 5.5 at z = 0 and 3.2 at z = 0.5 (docs/claims.md), in between taken as linear in q2.
    let rate = |q2: f64| z_rate * (5.5 + (3.2 - 5.5) * q2 / 1.756);
    let pose = |q2: f64| {
        let dq1 = -1.880 / 4.779 * q2.cos() * rate(q2) / manifold(q2).cos();
        [manifold(q2), q2, dq1, rate(q2)]
    };
    [_, _, variables.inputs.link1_rate, variables.inputs.link2_rate] = pose(0.0);
    let mut camera = started(&mut variables);
    let (mut q2, mut lost, mut i, mut frame) = (0.0, 0, 0, variables.outputs.frame);
    while q2 < 1.756 {
        let (from, to) = (f64::from(i) / 600.0, f64::from(i + 1) / 600.0);
        let half = q2 + rate(q2) / 1200.0;
        q2 += rate(half) / 600.0;
        step_to(&mut camera, &mut variables, from, to, pose(q2));
        i += 1;
        if variables.outputs.frame != frame {
            frame = variables.outputs.frame;
            lost += usize::from(!variables.outputs.valid);
        }
    }
    lost
}

#[test]
fn paper_c19_identification_is_lost_when_moving_too_fast() {
    // C19: with N_min 64 0.15/s is lost, 0.10/s passes; C20: with a small N_min 0.15/s is no threshold effect.
    assert_eq!(lost_at(0.10, 64), 0);
    assert!(lost_at(0.17, 64) > 0);
    assert_eq!(lost_at(0.15, 40), 0);
    assert!(lost_at(0.9, 1) > 0);
}
