use super::*;
use crate::dynamics::tests::{ROW, built, pendulum, place, units};

#[test]
fn value_members_are_told_apart_by_three_deviations() {
    // squared; one of the two for the other is enough to be found out, if that one is true
    assert_eq!(open(&vec![vec![0.0, 9.5], vec![9.3, 0.0]]), []);
    assert_eq!(open(&vec![vec![0.0, 8.6], vec![50.0, 0.0]]), [(0, 1)]);
    assert_eq!(open(&vec![vec![0.0, 50.0], vec![8.6, 0.0]]), [(0, 1)]);
}

#[test]
fn value_how_much_is_simulated_for_a_next_experiment() {
    let problem = pendulum("next", 600);
    let built = built(&problem);
    let members =
        [("tau:gain", 1.1), ("tau:bias", 0.002), ("q1:gain", 1.02), ("q1:offset", 0.01), ("q2:offset", 0.01)];
    let class: Vec<Alternative> = members
        .iter()
        .map(|(name, value)| Alternative {
            parameter: place(&built, name),
            loss: 0.0,
            value: *value,
            deviation: f64::INFINITY,
        })
        .collect();
    let theta = built.engine.machine.neutral();
    let (own, effects) = (class[0].parameter, [class[0].parameter]);
    let question =
        Question { engine: &built.engine, theta: &theta, noise: &built.noise, own, effects: &effects, class };
    let (next, scenario) = next(&problem, &question, &units()).expect("its torque can be driven");
    // a fit for each beside each: of four, twelve
    let names = ["tau:gain", "tau:bias", "q1:gain", "q1:offset"].map(|name| format!("acrobot_plant.{name}"));
    assert_eq!(next.separates, names);
    // those that screen best, and another: the screening is about the nominal model only
    let simulated = next.separation.iter().filter(|one| !one.pair.is_empty()).count();
    assert_eq!((simulated, next.separation.len()), (2, 6));
    // four hundred rows: each is in every fit
    let planned = next.planned.expect("it was simulated");
    let (last, _) = *planned.inputs[0].points.last().expect("a course");
    assert!((360.0..=440.0).contains(&(last / ROW)), "{last} s");
    assert!(scenario.is_some(), "one unit alone");
    // as far as the logs have seen the input, but not to its very ends: an amplifier that is set a little otherwise would clip
    let tau = &built.engine.grids[0].inputs[0].values;
    let size =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, value| most.max(value.abs()));
    let waves = waves(&problem, &built.engine, &built.engine.grids[0].time[..400]);
    let driven = waves.iter().map(|wave| size(&mut wave.values[0].iter().copied())).fold(0.0, f64::max);
    let share = driven / size(&mut tau.iter().copied());
    assert!((0.9..0.99).contains(&share), "{share}");
}
