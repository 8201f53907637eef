//! How much process noise comes from inputs that were measured: a sensor's noise on what is fed drives the model where nothing drove the
//! machine. It is white, acts where the input acts, and is no larger than what the rows of its log scatter by: so much is no evidence of
//! anything that the model lacks.
//!
//! Only where nothing was named. What is fed is off by that noise in the columns of the effects, too, which makes them smaller at high
//! frequencies than they are (errors in variables): an inductance, or a lag, that isn't there seems to explain that.

use crate::dynamics::Engine;
use crate::dynamics::machine::Role;
use crate::infer::fit::Linearise;
use crate::infer::likelihood::maximise;
use crate::infer::{Fit, Noise, Sizes};
use crate::nuisance::scatter;
use crate::observe::InputEffect;
use crate::statistics::levels::{MORE, anywhere_in};

/// The deviance with process noise up to what the logged inputs' own noise may give; nothing where none of them scatters, or effects were
/// named. `none` is a noise without any of the process.
pub(super) fn deviance(engine: &Engine, fit: &Fit, none: &Noise, sizes: &Sizes) -> Option<f64> {
    if !fit.free.is_empty() {
        return None;
    }
    let most = process(engine, fit)?;
    let within = |((least, most), own): (&(f64, f64), &f64)| (*least, own.clamp(*least, *most));
    let ranges: Vec<(f64, f64)> = sizes.process.iter().zip(&most).map(within).collect();
    let begun = Noise { process: ranges.iter().map(|(_, most)| *most).collect(), ..none.clone() };
    let sizes = Sizes { process: ranges, pinned: Vec::new(), ..sizes.clone() };
    Some(maximise(&fit.runs, &[], &begun, &sizes).1)
}

/// Process noise of each equation, unit of the state per √s.
fn process(engine: &Engine, fit: &Fit) -> Option<Vec<f64>> {
    let noisy = noisy(engine);
    if noisy.is_empty() {
        return None;
    }
    let columns: Vec<usize> = noisy.iter().map(|(parameter, _)| *parameter).collect();
    let runs = engine.linearise(&fit.at.theta, &fit.at.paths, &columns).ok()?;
    let order = engine.machine.order();
    let (mut squares, mut intervals) = (vec![0.0; order], 0.0);
    for run in &runs {
        for row in 0..run.rows().saturating_sub(1) {
            intervals += 1.0;
            for (place, (_, sd)) in noisy.iter().enumerate() {
                let by = run.column(row, place);
                for (square, by) in squares.iter_mut().zip(by) {
                    *square += (sd * by).powi(2) / run.interval(row);
                }
            }
        }
    }
    Some(squares.into_iter().map(|square| MORE * (square / f64::max(intervals, 1.0)).sqrt()).collect())
}

/// Biases of the logged inputs that scatter from row to row, and by how much.
fn noisy(engine: &Engine) -> Vec<(usize, f64)> {
    let parameters = engine.machine.parameters.iter().enumerate();
    let bias = |(place, role): (usize, &Role)| match role {
        Role::Input(input, InputEffect::Bias) if engine.machine.inputs[*input].channel.is_some() => {
            let courses: Vec<&[f64]> =
                engine.grids.iter().map(|grid| &grid.inputs[*input].values[..]).collect();
            Some((place, noise(&courses)))
        }
        _ => None,
    };
    parameters.filter_map(|(place, one)| bias((place, &one.role))).filter(|(_, sd)| *sd > 0.0).collect()
}

/// By how much an input's rows scatter between its steps; 0 where that is no more than rounding, or steps that are all of one size.
fn noise(courses: &[&[f64]]) -> f64 {
    let scatter = scatter(courses);
    if scatter.quiet > MORE * anywhere_in(scatter.quantum) { scatter.quiet } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::noise;
    use crate::statistics::random::Random;

    #[test]
    fn value_which_inputs_scatter() {
        let mut random = Random::new(3);
        let steps: Vec<f64> = (0..400).map(|row| f64::from(row / 25 % 4)).collect();
        assert_eq!(noise(&[&steps]), 0.0, "a command");
        let measured: Vec<f64> = steps.iter().map(|step| step + 0.05 * random.normal()).collect();
        let sd = noise(&[&measured]);
        assert!((0.04..0.06).contains(&sd), "{sd}");
        let wave: Vec<f64> = (0..400).map(|row| libm::sin(0.05 * f64::from(row))).collect();
        assert!(noise(&[&wave]) < 1e-6, "it moves, and doesn't scatter");
        let rounded: Vec<f64> = wave.iter().map(|value| (20.0 * value).round() / 20.0).collect();
        assert_eq!(noise(&[&rounded]), 0.0, "rounding");
    }
}
