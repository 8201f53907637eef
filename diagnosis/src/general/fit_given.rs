//! A fit of what was asked for (`--fit`), in place of a search.

use super::residual;
use super::study::Studied;
use crate::diagnosis::Gap;
use crate::dynamics::build::Built;
use crate::dynamics::{Engine, Machine};
use crate::error::{Error, Notice};
use crate::infer::Sizes;
use crate::infer::fit::{At, Fit, Options as FitOptions, fit};
use crate::observe::Scale;
use crate::options::Options;
use crate::search::Policy;
use crate::search::class::Alternative;
use crate::search::trials::trials;
use orchestrator::nearest;

/// Fits the parameters that were asked for, and judges what is left.
pub(super) fn fit_given(
    mut built: Built,
    sizes: &Sizes,
    options: &Options,
    start: &At,
    policy: Policy,
) -> Result<Studied, Error> {
    let parameters = &built.engine.machine.parameters;
    let place = |name: &String| parameters.iter().position(|parameter| parameter.name == *name);
    let free: Vec<usize> = options.fit.iter().filter_map(place).collect();
    let here = fit_limits(&built.engine, start, &free, sizes)?;
    let residual = residual::judge_residual(&built.engine, &here, sizes, &policy);
    let tells = |place: &&usize| {
        let (least, most) = parameters[**place].range;
        here.deviation(**place) < most - least
    };
    let untold: Vec<&str> =
        free.iter().filter(|place| !tells(place)).map(|place| parameters[*place].name.as_str()).collect();
    if !untold.is_empty() {
        let message = format!(
            "the logs tell nothing of {}: any value in the range does, so that no value was fitted",
            untold.join(", ")
        );
        built.notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    }
    let stayed = stayed(&built.engine.machine, &free, &here.at.theta);
    if stayed {
        let message = format!(
            "nothing better than the nominal values was found of {}: the values that are told are these, and no answer",
            options.fit.join(", ")
        );
        built.notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    }
    let alone = |parameter: &usize| vec![Alternative::as_fitted(*parameter, &here)];
    let classes = free.iter().map(alone).collect();
    let told = if stayed {
        "nothing better than their nominal values was found"
    } else if residual.unlisted.is_some() {
        "they don't explain the data: process noise stays above its floor"
    } else {
        "they explain the data: what is left is noise"
    };
    let story = vec![format!("{} were fitted as asked for; {told}", options.fit.join(", "))];
    let nominal = start.paths.clone();
    Ok(Studied { effects: free, fit: here, nominal, residual, story, classes, built, policy, last: None })
}

/// The fit of these parameters. A limit that is off cuts nothing, and a little more of it doesn't either: it begins wherever the search would try
/// it, and the best of these fits is the answer.
fn fit_limits(engine: &Engine, start: &At, free: &[usize], sizes: &Sizes) -> Result<Fit, Error> {
    let fitted = |at: &At| fit(engine, at, free, Some(sizes), &FitOptions::default());
    let is_off = |place: &&usize| {
        engine.machine.parameters[**place].scale == Scale::Saturation && start.theta[**place] == 0.0
    };
    let mut best = fitted(start)?;
    for place in free.iter().filter(is_off) {
        for chord in trials(engine, &best.at.theta, *place) {
            let mut at = best.at.clone();
            at.theta[*place] = chord.to;
            // a limit that the unit can't be run with, or that leaves nothing of the log, is none
            if let Ok(other) = fitted(&at)
                && other.deviance < best.deviance
            {
                best = other;
            }
        }
    }
    Ok(best)
}

/// Whether a fit is where it began.
fn stayed(machine: &Machine, free: &[usize], theta: &[f64]) -> bool {
    free.iter().all(|place| theta[*place] == machine.parameters[*place].neutral)
}

/// Gaps as they are told: a fit that stayed at the nominal values closes none, whatever one without the rows left out does.
pub(super) fn claimed(gaps: Vec<Gap>, studied: &Studied, options: &Options) -> Vec<Gap> {
    let stays = !options.fit.is_empty()
        && stayed(&studied.built.engine.machine, &studied.effects, &studied.fit.at.theta);
    let claimed = |gap: Gap| Gap { closed: gap.closed.filter(|_| !stays), ..gap };
    gaps.into_iter().map(claimed).collect()
}

/// Whether the names that were given with options are parameters.
pub(super) fn check_names(machine: &Machine, options: &Options) -> Result<(), Error> {
    let known = || machine.parameters.iter().map(|parameter| parameter.name.as_str());
    let given = options.without.iter().map(|name| ("--without", name));
    for (option, given) in given.chain(options.fit.iter().map(|name| ("--fit", name))) {
        if known().all(|name| name != given) {
            let problem = format!("no candidate has this name; {}", nearest(given, known()));
            return Err(Error::Option { option, given: given.clone(), problem });
        }
    }
    if let Some(given) = options.fit.first().filter(|_| options.earlier.is_some()) {
        let problem = "an earlier diagnosis (--after) weighs the names that a search finds, and this fits given ones; take one of both".into();
        return Err(Error::Option { option: "--fit", given: given.clone(), problem });
    }
    let is_set = |name: &&String| {
        let parameter = machine.parameters.iter().find(|parameter| parameter.name == **name);
        parameter.is_some_and(|parameter| matches!(parameter.scale, Scale::Switch | Scale::Count))
    };
    if let Some(given) = options.fit.iter().find(is_set) {
        let problem =
            "it takes whole values only and can't be fitted; without --fit the search tries them".into();
        return Err(Error::Option { option: "--fit", given: given.clone(), problem });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::stayed;
    use crate::dynamics::tests::{built, pendulum, place};

    #[test]
    fn value_a_fit_that_is_where_it_began_is_known() {
        let built = built(&pendulum("stayed", 60));
        let machine = &built.engine.machine;
        let free = [place(&built, "theta_9"), place(&built, "tau:gain")];
        let mut theta = machine.neutral();
        assert!(stayed(machine, &free, &theta));
        theta[free[1]] += 1e-6;
        assert!(!stayed(machine, &free, &theta) && stayed(machine, &free[..1], &theta));
    }
}
