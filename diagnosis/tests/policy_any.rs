//! The numbers of the search against what chance does: sets of a linear machine of which the model lacks nothing.

use diagnosis::testing::{
    Disturbance, Linearised, Measured, Noise, Policy, Random, Sizes, maximise, reduced,
};

const ROWS: usize = 240;
const STEP: f64 = 0.1;
const CANDIDATES: usize = 12;
/// Sets: 1 in 10 000 may pass, so that in these hardly one does.
const SETS: u64 = 60;

/// An oscillator with two sensors, exactly as the model has it; columns are those of forces that nobody applied.
fn set(seed: u64) -> Linearised {
    let mut random = Random::new(seed);
    let (n, p) = (2, CANDIDATES);
    let (c, s) = (libm::cos(0.35) * 0.97, libm::sin(0.35) * 0.97);
    let mut state = [random.normal(), random.normal()];
    let waves: Vec<[f64; 3]> = (0..p).map(|_| [0, 1, 2].map(|_| random.normal())).collect();
    let mut run = Linearised {
        states: n,
        parameters: p,
        time: (0..ROWS).map(|row| row as f64 * STEP).collect(),
        first: vec![0],
        start: (vec![0.0; n], vec![10.0; n]),
        ..Linearised::default()
    };
    for row in 0..ROWS {
        for channel in 0..n {
            let noise = [0.1, 0.3][channel] * random.normal();
            let (residual, slope) = (state[channel] + noise, state[1 - channel]);
            run.measured.push(Measured { channel, time: run.time[row], residual, slope, weight: 1.0 });
            run.observe.extend((0..n).map(|i| if i == channel { 1.0 } else { 0.0 }));
            run.direct.extend((0..p).map(|_| 0.0));
        }
        run.first.push(run.measured.len());
        if row + 1 < ROWS {
            run.transition.extend([c, s, -s, c]);
            run.defect.extend([0.0; 2]);
            for wave in &waves {
                let push = wave[0] * libm::sin(wave[1] * 3.0 * run.time[row] + wave[2]);
                run.drive.extend([0.0, STEP * push]);
            }
            state = [c * state[0] + s * state[1], -s * state[0] + c * state[1]];
        }
    }
    run
}

fn sizes() -> Sizes {
    Sizes {
        channels: vec![Some(1e-4); 2],
        process: vec![(1e-6, 10.0); 2],
        pinned: Vec::new(),
        jitter: 0.3 * STEP,
    }
}

fn start() -> Noise {
    Noise { channels: vec![0.2; 2], process: vec![1e-2; 2], jitter: 1e-3 * STEP, disturbance: None }
}

/// What the best candidate gains, and what process noise or an unlisted input gains over none.
fn by_chance(seed: u64) -> (f64, f64) {
    let (runs, sizes) = ([set(seed)], sizes());
    let (noise, without) = maximise(&runs, &[], &start(), &sizes);
    let best = (0..CANDIDATES).map(|column| {
        let one = reduced(&runs, &noise, &[column]);
        one.score[0] * one.score[0] / one.gram[(0, 0)]
    });
    let exact = sizes.with_pinned(vec![true; 2]);
    let none = maximise(&runs, &[], &exact.quieted(start()), &exact).1;
    let unlisted = (0..2).map(|equation| {
        let disturbance = Some(Disturbance { equation, size: 0.1, memory: 10.0 * STEP });
        maximise(&runs, &[], &exact.quieted(Noise { disturbance, ..start() }), &exact).1
    });
    let least = unlisted.fold(without, f64::min);
    (best.fold(0.0, f64::max), none - least)
}

#[test]
fn law_chance_stays_below_what_a_name_and_an_unknown_need_and_not_far_below() {
    let policy = Policy::of(CANDIDATES, 2);
    let all: Vec<(f64, f64)> = (0..SETS).map(by_chance).collect();
    let largest = |of: fn(&(f64, f64)) -> f64| all.iter().map(of).fold(0.0, f64::max);
    let (name, unknown) = (largest(|one| one.0), largest(|one| one.1));
    assert!(
        name < policy.gain && unknown < policy.unknown,
        "{name} of {}, {unknown} of {}",
        policy.gain,
        policy.unknown
    );
    // the largest of 60 times 12 draws of χ² with one degree of freedom has a median of 10.8 and lies above 7 in 99.7 %:
    // a threshold of more than three times that would miss what could be seen
    assert!(policy.gain < 3.0 * name, "{name} of {}", policy.gain);
}

#[test]
fn value_thresholds_are_the_tails_of_chi_squared() {
    // scipy.stats.chi2.isf(1e-4 / m, 1)
    for (candidates, threshold) in [(1, 15.136_705), (20, 20.837_287), (60, 22.945_422)] {
        let policy = Policy::of(candidates, 1);
        // to the digits that stand here
        assert!((policy.gain - threshold).abs() < 1e-6, "{candidates}: {}", policy.gain);
        assert_eq!(policy.beside, 4.0 * policy.gain);
        // beside an unlisted input that gains little, and one that gains much
        assert_eq!(policy.beside(100.0).gain, policy.beside);
        assert_eq!(policy.beside(1e6).gain, 1e4);
    }
    // scipy.stats.chi2.isf(1e-4 / n, 2), twice
    for (equations, threshold) in [(1, 18.420_681), (5, 21.639_557)] {
        assert!((Policy::of(1, equations).unknown - 2.0 * threshold).abs() < 2e-6, "{equations}");
    }
}

#[test]
fn golden_the_numbers_of_the_search_stand() {
    // Moving one moves false and missed names, or what a search costs: measure both anew.
    let policy = Policy::of(20, 3);
    assert_eq!((policy.class, policy.looked, policy.fitted, policy.most), (9.0, 10, 4, 5));
}
