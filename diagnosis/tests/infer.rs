//! The sweep against the same Gaussian likelihood computed the slow way: one dense covariance of all values.

#![allow(clippy::needless_range_loop, reason = "rows and indices of matrices, as in the formulas")]

use diagnosis::testing::{
    Disturbance, Linearised, Measured, Noise, Sizes, maximise, profile, reduced, smooth, sweep,
};
use nalgebra::{DMatrix, DVector};

/// Deterministic numbers in (-1, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn some(&mut self, count: usize, scale: f64) -> Vec<f64> {
        (0..count).map(|_| scale * self.next()).collect()
    }
}

/// Three states, two parameters, two channels at uneven times with gaps, one outlier of weight 0.
fn run() -> Linearised {
    run_of(3)
}

/// The same with n states.
fn run_of(n: usize) -> Linearised {
    let mut numbers = Numbers(7);
    let (p, rows) = (2, 9);
    let mut time = vec![0.0];
    for row in 1..rows {
        time.push(time[row - 1] + 0.1 + 0.03 * numbers.next());
    }
    let mut transition = numbers.some((rows - 1) * n * n, 0.9 / n as f64);
    for row in 0..rows - 1 {
        for i in 0..n {
            transition[row * n * n + i * n + i] += 0.9;
        }
    }
    let mut first = vec![0];
    let mut measured = Vec::new();
    for (row, &at) in time.iter().enumerate() {
        for channel in 0..2 {
            if (row + channel) % 3 != 1 {
                let (residual, slope) = (numbers.next(), 2.0 * numbers.next());
                let weight = if row == 4 && channel == 1 { 0.0 } else { 1.0 };
                measured.push(Measured { channel, time: at, residual, slope, weight });
            }
        }
        first.push(measured.len());
    }
    Linearised {
        states: n,
        parameters: p,
        transition,
        drive: numbers.some((rows - 1) * n * p, 0.5),
        defect: numbers.some((rows - 1) * n, 0.2),
        observe: numbers.some(measured.len() * n, 1.0),
        direct: numbers.some(measured.len() * p, 0.3),
        start: (numbers.some(n, 0.3), [0.8, 1.2, 0.5].into_iter().cycle().take(n).collect()),
        follows: Vec::new(),
        // the last state stands for one behind those of the machine
        late: numbers.some((rows - 1) * (n - 1), 20.0),
        // behind one interval the state is as unknown as the first
        torn: (0..rows - 1).map(|row| row == 2).collect(),
        left_out: 0.0,
        time,
        first,
        measured,
    }
}

fn noise(disturbance: Option<Disturbance>) -> Noise {
    noise_of(3, disturbance)
}

/// The same with n states.
fn noise_of(n: usize, disturbance: Option<Disturbance>) -> Noise {
    let process = [0.3, 0.0, 0.7].into_iter().cycle().take(n).collect();
    Noise { channels: vec![0.1, 0.2], process, jitter: 0.02, disturbance }
}

/// Mean, sensitivity and covariance of all (states with unlisted input) and values, by plain propagation of linear maps.
/// Every random number is a coordinate of one big vector ξ ~ N(0, I): start, noise of each interval, noise of each value.
struct Dense {
    values: DMatrix<f64>,
    mean: DVector<f64>,
    columns: DMatrix<f64>,
    states: Vec<(DMatrix<f64>, DVector<f64>)>,
    process: Vec<DMatrix<f64>>,
}

fn dense(run: &Linearised, noise: &Noise) -> Dense {
    let (n, p, rows) = (run.states, run.parameters, run.rows());
    let used: Vec<usize> = (0..run.measured.len()).filter(|v| run.measured[*v].weight > 0.0).collect();
    let wide = n + 1;
    let noises = wide + (rows - 1) * wide + used.len();
    let clock = noises + (rows - 1) * n;
    let all = clock + rows - 1;
    let mut state = DMatrix::zeros(wide, all);
    let mut mean = DVector::zeros(wide);
    let mut sensitivity = DMatrix::zeros(wide, p);
    for i in 0..n {
        mean[i] = run.start.0[i];
        state[(i, i)] = run.start.1[i];
    }
    state[(n, n)] = noise.disturbance.map_or(0.0, |d| d.size);
    let mut out = Dense {
        values: DMatrix::zeros(used.len(), all),
        mean: DVector::zeros(used.len()),
        columns: DMatrix::zeros(used.len(), p),
        states: Vec::new(),
        process: Vec::new(),
    };
    for row in 0..rows {
        out.states.push((state.clone(), mean.clone()));
        for value in run.values(row) {
            let Some(place) = used.iter().position(|known| *known == value) else { continue };
            let m = run.measured[value];
            let h = DMatrix::from_fn(1, wide, |_, j| if j < n { run.observe[value * n + j] } else { 0.0 });
            out.values.set_row(place, &(&h * &state).row(0));
            let late = noise.jitter * m.slope;
            out.values[(place, wide + (rows - 1) * wide + place)] =
                (noise.channels[m.channel].powi(2) + late * late).sqrt();
            out.mean[place] = m.residual - (&h * &mean)[0];
            for c in 0..p {
                out.columns[(place, c)] = (&h * sensitivity.column(c))[0] + run.direct[value * p + c];
            }
        }
        if row + 1 == rows {
            break;
        }
        let dt = run.interval(row);
        let mut a = DMatrix::from_fn(n, n, |i, j| run.transition[row * n * n + i * n + j]);
        let mut g = (DMatrix::identity(n, n) + &a) * (0.5 * dt);
        if run.is_torn(row) {
            // begun anew: nothing of what was before, nor of what acts within
            (a, g) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        }
        let keeps = noise.disturbance.map_or(0.0, |d| (-dt / d.memory).exp());
        let mut whole = DMatrix::zeros(wide, wide);
        whole.view_mut((0, 0), (n, n)).copy_from(&a);
        if let Some(d) = noise.disturbance {
            whole.view_mut((0, n), (n, 1)).copy_from(&g.column(d.equation));
            whole[(n, n)] = keeps;
        }
        state = &whole * state;
        mean = &whole * mean;
        sensitivity = &whole * sensitivity;
        let mut w = DMatrix::zeros(n, all);
        for i in 0..n {
            mean[i] += run.defect[row * n + i];
            for c in 0..p {
                sensitivity[(i, c)] += run.column(row, c)[i];
            }
            w[(i, wide + row * wide + i)] = noise.process[i] / dt.sqrt();
        }
        let mut pushed = &g * &w + state.rows(0, n);
        if run.is_torn(row) {
            (0..n).for_each(|i| pushed[(i, noises + row * n + i)] = run.start.1[i]);
        }
        for i in 0..n - 1 {
            pushed[(i, clock + row)] =
                if run.is_torn(row) { 0.0 } else { noise.jitter * run.late[row * (n - 1) + i] };
        }
        state.rows_mut(0, n).copy_from(&pushed);
        out.process.push(w);
        if let Some(d) = noise.disturbance {
            state[(n, wide + row * wide + n)] = d.size * (1.0 - keeps * keeps).sqrt();
        }
    }
    out
}

fn close(a: f64, b: f64, what: &str) {
    // sums of a few hundred products of numbers near 1, in two orders
    assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{what}: {a} against {b}");
}

fn both(n: usize, disturbance: Option<Disturbance>) {
    let (run, noise) = (run_of(n), noise_of(n, disturbance));
    let reduced = sweep(&run, &noise, &[0, 1]);
    let dense = dense(&run, &noise);
    let covariance = &dense.values * dense.values.transpose();
    let solved = covariance.clone().cholesky().expect("noise makes it positive");
    let weighted = solved.solve(&dense.mean);
    close(reduced.square, dense.mean.dot(&weighted), "square");
    close(reduced.log_det, solved.determinant().ln(), "log det");
    let score = dense.columns.transpose() * &weighted;
    let gram = dense.columns.transpose() * solved.solve(&dense.columns);
    for i in 0..2 {
        close(reduced.score[i], score[i], "score");
        for j in 0..2 {
            close(reduced.gram[(i, j)], gram[(i, j)], "gram");
        }
    }
    let smoothed = smooth(&run, &noise);
    for (row, (state, mean)) in dense.states.iter().enumerate() {
        let most_likely = mean + state * dense.values.transpose() * &weighted;
        for i in 0..n {
            close(smoothed.state[row * n + i], most_likely[i], "smoothed state");
        }
        if disturbance.is_some() {
            close(smoothed.disturbance[row], most_likely[n], "unlisted input");
        }
    }
    for (row, process) in dense.process.iter().enumerate() {
        let most_likely = process * dense.values.transpose() * &weighted;
        for i in 0..n {
            close(smoothed.process[row * n + i], most_likely[i], "process noise");
        }
    }
}

#[test]
fn law_the_sweep_is_the_dense_gaussian_likelihood() {
    // 7 and 13 states are no sizes that the filter is compiled for: the next larger does it
    [3, 7, 13].into_iter().for_each(|n| both(n, None));
}

#[test]
fn law_the_same_with_an_unlisted_input_that_remembers() {
    let unlisted = Disturbance { equation: 2, size: 0.9, memory: 0.35 };
    [3, 6, 14].into_iter().for_each(|n| both(n, Some(unlisted)));
}

/// One state that nothing drives, read at each row with white noise whose deviation is `size` in stretches of fifty rows at
/// `loud`, 1 elsewhere; the parameter is an offset of the value.
fn white(loud: impl Fn(usize) -> bool, size: f64) -> Linearised {
    let mut random = diagnosis::testing::Random::new(4);
    let rows = 2000;
    let measured = |row: usize| {
        let sd = if loud(row / 50) { size } else { 1.0 };
        Measured { channel: 0, time: row as f64, residual: sd * random.normal(), slope: 0.0, weight: 1.0 }
    };
    Linearised {
        states: 1,
        parameters: 1,
        time: (0..rows).map(|row| row as f64).collect(),
        transition: vec![0.0; rows - 1],
        drive: vec![0.0; rows - 1],
        defect: vec![0.0; rows - 1],
        first: (0..=rows).collect(),
        measured: (0..rows).map(measured).collect(),
        observe: vec![0.0; rows],
        direct: vec![1.0; rows],
        late: Vec::new(),
        start: (vec![0.0], vec![1.0]),
        follows: Vec::new(),
        torn: Vec::new(),
        left_out: 0.0,
    }
}

#[test]
fn law_the_sandwich_is_the_inverse_gram_matrix_where_the_noise_is_as_said_and_more_where_not() {
    let noise = Noise { channels: vec![1.0], process: vec![0.0], jitter: 0.0, disturbance: None };
    let variance = |run: Linearised| {
        diagnosis::testing::sandwich(&[run], &noise, &[0]).expect("the value tells")[(0, 0)]
    };
    let exact = 1.0 / 2000.0;
    let same = variance(white(|_| false, 1.0)) / exact;
    // a variance of 20 scores is known to a third; three of these
    assert!(same > 0.3 && same < 2.0, "{same}");
    // a quarter of the rows with a hundredfold variance: 26 times as much in all, by ten loud scores
    let more = variance(white(|stretch| stretch % 4 == 1, 10.0)) / exact;
    assert!(more > 6.0 && more < 80.0, "{more}");
}

/// -2 log likelihood with the parameters where it is least, the slow way.
fn profiled(run: &Linearised, noise: &Noise) -> (f64, Vec<f64>) {
    let reduced = sweep(run, noise, &[0, 1]);
    let shift = reduced.gram.clone().lu().solve(&reduced.score).expect("both parameters show");
    let deviance = reduced.square - shift.dot(&reduced.score) + reduced.log_det;
    (deviance, shift.iter().copied().collect())
}

#[test]
fn law_the_gradient_by_the_adjoint_is_that_of_differences() {
    for disturbance in [None, Some(Disturbance { equation: 2, size: 0.9, memory: 0.35 })] {
        let (run, mut noise) = (run(), noise(disturbance));
        noise.process[1] = 0.2;
        let shift = profiled(&run, &noise).1;
        let (_, kept) = diagnosis::testing::sweep_columns(&run, &noise, &[0, 1]);
        let found =
            diagnosis::testing::gradient(std::slice::from_ref(&run), &noise, &[0, 1], &shift, &[&kept]);
        let step = 1e-5;
        let by = |change: &dyn Fn(&mut Noise, f64)| {
            let at = |factor: f64| {
                let mut there = noise.clone();
                change(&mut there, factor);
                profiled(&run, &there).0
            };
            (at(f64::exp(step)) - at(f64::exp(-step))) / (2.0 * step)
        };
        // central differences over 1e-5 of a sum near 100 are good to 1e-9 of it over the step
        let same = |a: f64, b: f64, what: &str| assert!((a - b).abs() < 1e-4, "{what}: {a} against {b}");
        for channel in 0..2 {
            same(found.channels[channel].first, by(&|n, f| n.channels[channel] *= f), "channel");
        }
        for equation in 0..3 {
            same(found.process[equation].first, by(&|n, f| n.process[equation] *= f), "process");
        }
        same(found.jitter.first, by(&|n, f| n.jitter *= f), "jitter");
        let scaled = |n: &mut Noise, f: f64| {
            if let Some(unlisted) = &mut n.disturbance {
                unlisted.size *= f;
            }
        };
        same(found.disturbance.first, by(&scaled), "unlisted input");
    }
}

#[test]
fn law_what_values_left_out_would_have_counts_wherever_a_deviance_is_compared() {
    let plain = white(|row| row % 2 == 0, 0.3);
    let without = Linearised { left_out: 7.0, ..plain.clone() };
    let sizes =
        Sizes { channels: vec![Some(0.01)], process: vec![(1e-6, 1.0)], pinned: Vec::new(), jitter: 0.0 };
    let noise = Noise { channels: vec![0.2], process: vec![0.1], jitter: 0.0, disturbance: None };
    let both = |run: &Linearised| {
        let runs = [run.clone()];
        [profile(&reduced(&runs, &noise, &[])), maximise(&runs, &[], &noise, &sizes).1]
    };
    for (with, without) in both(&without).iter().zip(both(&plain)) {
        // sums of a hundred logarithms in another order
        assert!((with - without - 7.0).abs() < 1e-9, "{with} {without}");
    }
}
