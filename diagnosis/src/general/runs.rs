//! Runs that differ: what has no name in all of them together goes where one parameter may have a value of its own in each, a payload in one
//! of them, say. That is no effect of the model, so it is told as the shape of what is left and not named.

use super::residual;
use super::sensor;
use super::study::Studied;
use crate::diagnosis::Unknown;
use crate::dynamics::build::build;
use crate::dynamics::first_path::Trails;
use crate::error::Error;
use crate::infer::fit::{Linearise, Options, fit};
use crate::infer::likelihood::reduced;
use crate::infer::{Fit, Linearised};
use crate::observe::{Problem, Run, Scale};
use crate::options::Options as Asked;
use crate::statistics::levels::FEW;
use crate::statistics::linear::Reduced;
use crate::watch::Watch;

/// What ends early where time is up.
const COMPARED: &str = "the comparison of the runs";

/// A parameter with a value of its own in each run.
struct Apart {
    parameter: usize,
    /// Value and its standard deviation, run by run.
    values: Vec<(f64, f64)>,
    /// -2 log likelihood of all runs together.
    deviance: f64,
}

/// What has no name, with the words that runs differ where that explains it. A unit that fails on the way, or time that is up, leaves it
/// as it is: the diagnosis stands without.
pub fn shaped(
    problem: &Problem,
    studied: &Studied,
    options: &Asked,
    unknown: Option<Unknown>,
    watch: &mut Watch<'_>,
) -> Option<Unknown> {
    let left = unknown?;
    if problem.runs.len() < 2 || watch.is_over(COMPARED) {
        return Some(left);
    }
    watch.stage("comparing the runs");
    Some(match differ(problem, studied, options, watch) {
        Some(shape) => Unknown {
            shape,
            depends_on: Vec::new(),
            nearest: "with one value in all runs no listed effect takes it away".into(),
            ..left
        },
        None => left,
    })
}

/// In what runs differ, if values of their own leave noise in each.
fn differ(problem: &Problem, studied: &Studied, options: &Asked, watch: &mut Watch<'_>) -> Option<String> {
    let ranked = ranked(problem, studied, options).ok()?;
    let mut found: Vec<Apart> = Vec::new();
    for (place, parameter) in ranked.iter().enumerate() {
        watch.trying(&studied.built.engine.machine.parameters[*parameter].name, place + 1, ranked.len());
        found.extend(apart(problem, studied, *parameter, watch));
    }
    found.sort_by(|a, b| a.deviance.total_cmp(&b.deviance));
    let best = found.first()?;
    let alike = found.iter().filter(|one| one.deviance - best.deviance < studied.policy.class);
    let told: Vec<String> = alike.map(|one| describe_values(problem, studied, one)).collect();
    Some(format!("runs that differ: {}", told.join("; or ")))
}

/// The parameters by which the runs differ most, as the linearisation about what was found shows it.
fn ranked(problem: &Problem, studied: &Studied, options: &Asked) -> Result<Vec<usize>, Error> {
    let engine = &studied.built.engine;
    let moves = |place: &usize| {
        let parameter = &engine.machine.parameters[*place];
        matches!(parameter.scale, Scale::Absolute | Scale::Relative)
            && !options.without.contains(&parameter.name)
    };
    let columns: Vec<usize> = (0..engine.machine.parameters.len()).filter(moves).collect();
    let (at, noise) = (&studied.fit.at, studied.residual.unlisted.as_ref().unwrap_or(&studied.fit.at.noise));
    let lines = engine.linearise(&at.theta, &at.paths, &columns)?;
    let of = |run: &Run| -> Vec<Linearised> {
        let own = engine.grids.iter().zip(&lines).filter(|(grid, _)| grid.name == run.name);
        own.map(|(_, lines)| lines.clone()).collect()
    };
    let places: Vec<usize> = (0..columns.len()).collect();
    let runs: Vec<Reduced> = problem.runs.iter().map(|run| reduced(&of(run), noise, &places)).collect();
    let mut gains: Vec<(f64, usize)> =
        places.iter().map(|place| (gain_of_own_values(&runs, *place), columns[*place])).collect();
    gains.sort_by(|a, b| b.0.total_cmp(&a.0));
    gains.retain(|(gain, _)| *gain > studied.policy.sure);
    Ok(gains.into_iter().take(FEW).map(|(_, parameter)| parameter).collect())
}

/// Deviance that values of their own gain over a common one: Σ s²/g - (Σ s)²/Σ g.
fn gain_of_own_values(runs: &[Reduced], place: usize) -> f64 {
    let each = || {
        runs.iter().map(|run| (run.score[place], run.gram[(place, place)])).filter(|(_, gram)| *gram > 0.0)
    };
    let (score, gram) = each().fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    if gram > 0.0 {
        each().map(|(score, gram)| score * score / gram).sum::<f64>() - score * score / gram
    } else {
        0.0
    }
}

/// The parameter fitted to each run by itself, beside what was found and without that; `None` where something is left without a name.
fn apart(problem: &Problem, studied: &Studied, parameter: usize, watch: &mut Watch<'_>) -> Option<Apart> {
    let machine = &studied.built.engine.machine;
    let mut begins = vec![studied.fit.at.theta.clone()];
    if studied.effects.iter().any(|effect| *effect != parameter) {
        begins.push(machine.neutral());
    }
    let each = |begin: Vec<f64>| {
        let own = |run| match watch.is_over(COMPARED) {
            true => None,
            false => fit_one_run(problem, studied, run, parameter, &begin).ok()?,
        };
        let fits: Vec<Fit> = problem.whole_runs().into_iter().map(own).collect::<Option<_>>()?;
        Some(Apart {
            parameter,
            values: fits.iter().map(|fit| (fit.at.theta[parameter], fit.deviation(parameter))).collect(),
            deviance: fits.iter().map(|fit| fit.deviance).sum(),
        })
    };
    begins.into_iter().filter_map(each).min_by(|a, b| a.deviance.total_cmp(&b.deviance))
}

/// One run's fit, where it leaves noise only.
fn fit_one_run(
    problem: &Problem,
    studied: &Studied,
    run: (&Run, (f64, f64)),
    parameter: usize,
    begin: &[f64],
) -> Result<Option<Fit>, Error> {
    let mut built = build(problem, &[run])?;
    let mut known = Trails::default();
    known.add(&studied.built.engine, &studied.fit.at.paths);
    let (at, _) = built.begin_fit(begin, &known, &[])?;
    let fit = fit(&built.engine, &at, &[parameter], Some(&built.sizes), &Options::default())?;
    let residual = residual::judge_residual(&built.engine, &fit, &built.sizes, &studied.policy);
    let (effects, nominal, policy) = (vec![parameter], at.paths, studied.policy);
    let own = Studied {
        built,
        effects,
        fit,
        nominal,
        residual,
        policy,
        last: None,
        story: Vec::new(),
        classes: Vec::new(),
    };
    let explained = own.residual.unlisted.is_none() && sensor::unknown(problem, &own).is_none();
    Ok(explained.then_some(own.fit))
}

fn describe_values(problem: &Problem, studied: &Studied, apart: &Apart) -> String {
    let parameter = &studied.built.engine.machine.parameters[apart.parameter];
    let each = problem.runs.iter().zip(&apart.values);
    let each: Vec<String> =
        each.map(|(run, (value, sd))| format!("{} in {}", brief(*value, *sd), run.name)).collect();
    format!("{} ({}) would be {}", parameter.name, parameter.phrase, each.join(", "))
}

/// A value to the digit that its standard deviation leaves, and one more.
fn brief(value: f64, deviation: f64) -> String {
    let digits = libm::floor(libm::log10(value.abs())) - libm::floor(libm::log10(deviation)) + 1.0;
    // a double has no more than 15 for sure; of what nobody knows all are told
    let digits = if deviation.is_finite() {
        digits.clamp(1.0, f64::from(f64::DIGITS)) as usize
    } else {
        f64::DIGITS as usize
    };
    let text: f64 = format!("{value:.digits$e}").parse().unwrap_or(value);
    format!("{text}")
}

#[cfg(test)]
mod tests {
    use super::{brief, gain_of_own_values};
    use crate::statistics::linear::Reduced;

    #[test]
    fn value_what_values_of_their_own_gain() {
        let run = |score: f64, gram: f64| {
            let mut one = Reduced::zero(1);
            (one.score[0], one.gram[(0, 0)]) = (score, gram);
            one
        };
        // runs that ask for the same shift, each as well known as it likes
        assert!(gain_of_own_values(&[run(2.0, 1.0), run(200.0, 100.0)], 0).abs() < 1e-9);
        // shifts of 1 and -1, each known to 0.1: 100 each against a common shift of 0
        assert!((gain_of_own_values(&[run(100.0, 100.0), run(-100.0, 100.0)], 0) - 200.0).abs() < 1e-9);
        // a run that tells nothing
        assert!(gain_of_own_values(&[run(2.0, 1.0), run(0.0, 0.0)], 0).abs() < 1e-9);
    }

    #[test]
    fn value_digits_that_are_told() {
        assert_eq!(brief(0.069_987_3, 2.4e-5), "0.069987");
        assert_eq!(brief(389.79, 1.2), "389.8");
        assert_eq!(brief(155_949.6, 310.0), "155950");
        // an effect that is hardly off, one that is off to rounding, and a capacity that nobody told the value of
        assert_eq!(brief(-5.4e-4, 3e-4), "-0.00054");
        assert_eq!(brief(0.0, 0.1), "0");
        assert_eq!(brief(0.1 + 0.2, 0.0), "0.3");
        assert_eq!(brief(2.5, f64::INFINITY), "2.5");
    }
}
