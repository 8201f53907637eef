//! Whether `fmi2Reset` brings an instance back to where it began: those of some tools keep their clock, their inputs or the state of a
//! solver, and a second run would silently be another. Looked at once a unit, when an instance is first used again.
//!
//! An instance steps a little from its own start, is reset, and steps again: every value must be the same to the bit. A unit of which
//! that is not so gets a fresh instance for each run.

use super::description::{Causality, Description, Variability};
use super::{Fmu, Instance, Status};
use crate::error::Error;
use crate::value::Kind;

/// Steps that are compared: what an instance keeps shows in the first, or in the second where the first only catches up.
const STEPS: u32 = 3;
/// An input is moved off its start value by this share of it, so that a unit at rest begins to move.
const MOVED: f64 = 0.01;
/// Length of a step where the description proposes none, s.
const USUAL: f64 = 0.01;

impl Fmu {
    /// Whether an instance that was reset runs as a fresh one.
    pub fn restores(&self) -> bool {
        *self.inner.restores.get_or_init(|| self.tried_twice().unwrap_or(false))
    }

    fn tried_twice(&self) -> Result<bool, Error> {
        let mut instance = self.instantiate("reset")?;
        let first = instance.trace()?;
        instance.reset_itself()?;
        Ok(instance.trace()? == first)
    }
}

impl Instance {
    /// A few steps from the unit's own start; all that it shows, as bits.
    fn trace(&mut self) -> Result<Vec<u64>, Error> {
        let fmu = self.fmu().clone();
        let description = fmu.description();
        let start = description.default_experiment.start.unwrap_or(0.0);
        let step = description.default_experiment.step_size.filter(|step| *step > 0.0 && step.is_finite());
        let step = step.unwrap_or(USUAL);
        let (inputs, shown) = (moved(description), shown(description));
        self.setup_experiment(start, None)?;
        self.enter_initialization()?;
        self.exit_initialization()?;
        let mut all = Vec::new();
        let mut values = vec![0.0; shown.len()];
        for count in 0..=STEPS {
            self.get_real(&shown, &mut values)?;
            all.extend(values.iter().map(|value| value.to_bits()));
            for (reference, value) in &inputs {
                self.set_real(&[*reference], &[*value])?;
            }
            let from = start + f64::from(count) * step;
            match self.do_step(from, step, true) {
                Status::Ok | Status::Warning => {}
                status => return Err(self.step_error(status, from)),
            }
        }
        Ok(all)
    }
}

/// Real inputs, each a little off its start value and within its bounds.
fn moved(description: &Description) -> Vec<(u32, f64)> {
    let inputs = description.variables.iter().filter(|variable| {
        variable.kind == Kind::Real
            && variable.causality == Causality::Input
            && variable.variability == Variability::Continuous
    });
    let value = |variable: &super::Variable| {
        let start = variable.start.as_ref().and_then(crate::Value::as_f64).unwrap_or(0.0);
        let (least, most) =
            (variable.min.unwrap_or(f64::NEG_INFINITY), variable.max.unwrap_or(f64::INFINITY));
        let by = MOVED * start.abs().max(1.0);
        let there = if start + by <= most { start + by } else { f64::max(start - by, least) };
        (variable.reference, there)
    };
    inputs.map(value).collect()
}

/// All real values: what moves, and what a reset should have put back.
fn shown(description: &Description) -> Vec<u32> {
    let all = description.variables.iter().filter(|variable| variable.kind == Kind::Real);
    all.map(|variable| variable.reference).collect()
}

#[cfg(test)]
mod tests {
    use super::{Description, moved, shown};

    #[test]
    fn value_inputs_move_by_a_share_and_stay_within_their_bounds() {
        let variable = |(number, (causality, rest)): (usize, &(&str, &str))| {
            format!(
                "<ScalarVariable name=\"v{number}\" valueReference=\"{number}\" causality=\"{causality}\">{rest}</ScalarVariable>"
            )
        };
        let variables = [
            ("input", "<Real start=\"0\"/>"),
            ("input", "<Real start=\"-200\"/>"),
            ("input", "<Real start=\"200\" max=\"202\"/>"),
            ("input", "<Real start=\"200\" max=\"201\"/>"),
            ("input", "<Real start=\"1\" min=\"1\" max=\"1\"/>"),
            ("input", "<Integer start=\"1\"/>"),
            ("output", "<Real/>"),
        ];
        let text = format!(
            "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"m\" guid=\"g\"><CoSimulation modelIdentifier=\"m\"/>\
             <ModelVariables>{}</ModelVariables><ModelStructure/></fmiModelDescription>",
            variables.iter().enumerate().map(variable).collect::<String>()
        );
        let description = Description::parse(&text).expect("a description");
        assert_eq!(moved(&description), [(0, 0.01), (1, -198.0), (2, 202.0), (3, 198.0), (4, 1.0)]);
        assert_eq!(shown(&description), [0, 1, 2, 3, 4, 6]);
    }
}
