//! Effects at ports as parameters of the machine: of each fed input and compared output those that the data set admits.

use super::machine::{Machine, Parameter, Role};
use crate::observe::{InputEffect, Problem, Run};
use crate::ports::{Kind, PORTS};

/// The parameters of all ports.
pub(super) fn port_parameters(machine: &Machine, problem: &Problem) -> Vec<Parameter> {
    let span = |run: &Run| {
        let (first, last) = run.span();
        last - first
    };
    let shortest = problem.runs.iter().map(span).fold(f64::INFINITY, f64::min);
    let latest = if shortest.is_finite() { PORTS.latest * shortest } else { f64::INFINITY };
    let mut list = Vec::new();
    for (place, input) in machine.inputs.iter().enumerate() {
        let open =
            |effect: &InputEffect| input.channel.is_some() || input.open && *effect == InputEffect::Bias;
        for effect in problem.ports.inputs.iter().copied().filter(open) {
            let kind = Kind::of_input(effect);
            list.push(Parameter {
                name: format!("{}:{}", input.name, effect.name()),
                phrase: format!("{} of the input {}", kind.words, input.name),
                neutral: kind.neutral,
                range: kind.range(latest),
                scale: kind.scale,
                role: Role::Input(place, effect),
            });
        }
    }
    for (place, output) in machine.channels.iter().enumerate() {
        for effect in problem.ports.outputs.iter().copied() {
            let kind = Kind::of_output(effect);
            list.push(Parameter {
                name: format!("{}:{}", output.name, effect.name()),
                phrase: format!("{} of the measured {}", kind.words, output.name),
                neutral: kind.neutral,
                range: kind.range(latest),
                scale: kind.scale,
                role: Role::Output(place, effect),
            });
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use crate::dynamics::tests::{built, pendulum, place};

    #[test]
    fn value_how_large_effects_at_ports_may_be() {
        let problem = pendulum("ports", 101);
        let built = built(&problem);
        let holds = |name: &str, value: f64| {
            let (least, most) = built.engine.machine.parameters[place(&built, name)].range;
            (least..=most).contains(&value)
        };
        // runs of 2 s: what comes later than a tenth of them leaves too little that came in time
        for late in ["tau:delay", "tau:lag", "q1:delay", "q1:lag"] {
            assert!(holds(late, 0.18) && !holds(late, 0.22) && !holds(late, -0.01), "{late}");
        }
        // a worn or wrongly set amplifier; beyond it a wire is broken, or the unit of measurement is another (mA, km/h, degrees)
        for gain in ["tau:gain", "q2:gain"] {
            assert!(holds(gain, 0.055) && !holds(gain, 0.045) && holds(gain, 18.0) && !holds(gain, 22.0));
            assert!(!holds(gain, -1.0), "a turned sign is doubted before");
        }
    }
}
