//! What code asks of a candidate: an attribute of its entry, so that no name stands outside the list.

use super::{Candidate, Entry, LIST};
use crate::observe::InputEffect;

/// The attributes: those that say no more than their name, of which there is a list, and those with a value.
macro_rules! attributes {
    (
        plain { $($(#[$doc:meta])* $plain:ident),* $(,)? }
        valued { $($(#[$more:meta])* $valued:ident($value:ty)),* $(,)? }
    ) => {
        /// What a candidate is or does, as far as the diagnosis treats it otherwise than the rest.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Attribute {
            $($(#[$doc])* $plain,)*
            $($(#[$more])* $valued($value),)*
        }

        /// All that say no more than their name.
        #[cfg(test)]
        const PLAIN: &[Attribute] = &[$(Attribute::$plain),*];
    };
}

attributes! {
    plain {
        /// Viscous or Coulomb friction: corrections have it in forms of their own.
        Friction,
        /// The arm rests until it is pushed hard enough.
        Sticks,
        /// Acts between command and joint.
        InActuator,
        /// Needs time to act there.
        OverTime,
        /// The torque arrives late by it.
        Retards,
        /// A torque that is there whatever is commanded.
        Bias,
        /// All torques of the actuator go with it.
        Gain,
        /// Where the ground lies, on which an arm rolls.
        Ground,
        /// Couples rolling and links: nothing where the arm is pinned.
        Rolls,
        /// How heavy a link is to turn.
        LinkInertia,
        /// How far a motor at the joint must reach to hold the second link.
        JointWeight,
        /// The image is late by it; it moves nothing else.
        ImageDelay,
        /// A term of the lens's radial series: of a real lens these have opposite signs and mostly cancel (Brown 1971).
        RadialSeries,
        /// How long an image is exposed.
        Exposure,
        /// The camera turned about its axis.
        CameraRoll,
        /// Noise of the camera's sensor.
        SensorNoise,
        /// The share of frames that get lost.
        LostFrames,
    }
    valued {
        /// By how much the log of an angle reads too large; the place of that angle, from 0.
        Zero(usize),
        /// What the actuator does to the torque on its way, as at any unit's port.
        AtPort(InputEffect),
    }
}

impl Entry {
    /// Whether it has an attribute.
    pub fn is(&self, attribute: Attribute) -> bool {
        self.attributes.contains(&attribute)
    }
}

impl Candidate {
    /// Whether it has an attribute.
    pub fn is(&self, attribute: Attribute) -> bool {
        self.attributes.contains(&attribute)
    }

    /// The angle whose zero in the log it is, by its place.
    pub fn zero(&self) -> Option<usize> {
        self.attributes
            .iter()
            .find_map(|one| if let Attribute::Zero(angle) = one { Some(*angle) } else { None })
    }

    /// What it does at the port of the torque, if it is a part of the actuator.
    pub fn at_port(&self) -> Option<InputEffect> {
        at_port(self.attributes)
    }
}

fn at_port(attributes: &[Attribute]) -> Option<InputEffect> {
    attributes.iter().find_map(|one| if let Attribute::AtPort(effect) = one { Some(*effect) } else { None })
}

/// The parts of the actuator: names, and what each does at the port of the torque.
pub fn actuator() -> impl Iterator<Item = (&'static str, InputEffect)> {
    LIST.iter().filter_map(|entry| Some((entry.name, at_port(entry.attributes)?)))
}

/// Names of all entries with an attribute, as `instance.variable`.
pub fn names(attribute: Attribute) -> impl Iterator<Item = &'static str> {
    LIST.iter().filter(move |entry| entry.is(attribute)).map(|entry| entry.name)
}

/// The first of them; each attribute has one.
pub fn name(attribute: Attribute) -> &'static str {
    names(attribute).next().unwrap_or_default()
}

/// A name without its instance: the variable in its unit.
pub fn variable(name: &str) -> &str {
    name.split_once('.').map_or(name, |(_, variable)| variable)
}

/// Where the first candidate of a diagnosis with an attribute stands, if there is one.
pub fn place(list: &[Candidate], attribute: Attribute) -> Option<usize> {
    list.iter().position(|candidate| candidate.is(attribute))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::channels::CHANNELS;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::{Path, PathBuf};

    fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("the sources are there") {
            let path = entry.expect("the sources are there").path();
            if path.is_dir() {
                sources(&path, into);
            } else if path.extension().is_some_and(|ext| ext == "rs") {
                into.push(path);
            }
        }
    }

    /// Each line of code that is no test, comment or list: where it stands, and its texts in quotes.
    fn quoted(each: &mut dyn FnMut(String, &str)) {
        let mut files = Vec::new();
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
        for path in files {
            // the list itself; tests may say what they hide
            if path.ends_with("candidates/list.rs") || path.ends_with("tests.rs") {
                continue;
            }
            let text = fs::read_to_string(&path).expect("a source");
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            for (line, words) in code.lines().enumerate().filter(|(_, line)| !line.trim().starts_with("//")) {
                let texts = words.split('"').skip(1).step_by(2);
                texts.for_each(|text| each(format!("{}:{}", path.display(), line + 1), text));
            }
        }
    }

    #[test]
    fn no_candidate_is_named_outside_the_list() {
        let mut named = Vec::new();
        quoted(&mut |place, text| {
            if LIST.iter().any(|entry| entry.name == text) {
                named.push(format!("{place}: {text}"));
            }
        });
        assert!(
            named.is_empty(),
            "attributes of candidates/list.rs say what code wants to know:\n{}",
            named.join("\n")
        );
    }

    #[test]
    fn every_variable_that_code_names_is_a_channel_or_wiring() {
        // files of a run; what a run is driven by and told to do; an event and a clock that a recording is read by
        const WIRING: [&str; 8] = [
            "plant.csv",
            "camera.csv",
            "controller.csv",
            "controller.z_desired",
            "plant.tolerance",
            "plant.contact",
            "controller.frame",
            "camera.frame_index",
        ];
        let mut others = Vec::new();
        quoted(&mut |place, text| {
            let Some((unit, variable)) = text.split_once('.') else { return };
            let names = ["plant", "camera", "controller"].contains(&unit)
                && !variable.is_empty()
                && variable.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
            let channel = CHANNELS.iter().any(|channel| channel.column == variable);
            if names && !channel && !WIRING.contains(&text) && !place.contains("/parameters.rs:") {
                others.push(format!("{place}: {text}"));
            }
        });
        assert!(others.is_empty(), "parameters.rs names the rig's own parameters:\n{}", others.join("\n"));
    }

    #[test]
    fn every_attribute_has_an_entry() {
        use Attribute::*;
        assert!(PLAIN.iter().all(|attribute| names(*attribute).count() > 0));
        assert!((0..2).all(|angle| names(Zero(angle)).count() == 1));
        // what is in the actuator, its gain and its bias are all that a torque passes
        let passed: BTreeSet<&str> = [InActuator, Gain, Bias].into_iter().flat_map(names).collect();
        assert_eq!(passed, actuator().map(|(name, _)| name).collect());
        // what takes time is a part of the actuator, and so is what makes it late
        let within = |small, large| names(small).all(|name| names(large).any(|other| other == name));
        assert!(within(OverTime, InActuator) && within(Retards, OverTime) && within(Sticks, Friction));
    }
}
