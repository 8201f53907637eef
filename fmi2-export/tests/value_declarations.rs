//! Declarations beside the toy's: what their descriptions say, and which mistakes are told.

#![allow(unsafe_code)] // calls the C functions as a master does
use crate::common::Toy;
use fmi2_export::abi::{lifecycle, types};
use fmi2_export::description::Unit;
use fmi2_export::unit::{self, Unit as Physical};
use fmi2_export::{Dependencies, Description, Experiment, Log, Model, ModelError, Step, Table, variables};
use serde::{Deserialize, Serialize};
use std::ffi::c_void;
use std::ptr;

fn head() -> Description {
    Description {
        identifier: "a_unit",
        description: "A unit.",
        version: "1",
        stop_time: 1.0,
        step_size: 0.1,
        provides_derivatives: false,
        log_categories: &[],
    }
}

/// A unit that only says what it is.
macro_rules! unit_of {
    ($Name:ident, $Variables:ty, $head:expr) => {
        #[derive(Debug, Clone, Default, Serialize, Deserialize)]
        struct $Name;

        impl Model for $Name {
            type Variables = $Variables;
            fn description() -> Description {
                $head
            }
            fn dependencies(_: &str) -> Dependencies {
                Dependencies { while_stepping: &[], at_start: Some(&[]) }
            }
            fn initialize(
                &mut self,
                _: &mut $Variables,
                _: &Experiment,
                _: &mut dyn Log,
            ) -> Result<(), ModelError> {
                Ok(())
            }
            fn step(&mut self, _: &mut $Variables, _: &Step<'_>, _: &mut dyn Log) -> Result<(), ModelError> {
                Ok(())
            }
        }
    };
}

/// Grams: a unit with a factor.
const GRAM: Physical =
    Physical { name: "g", exponents: [1, 0, 0, 0, 0, 0, 0, 0], factor: 0.001, display: &[] };

variables! {
    /// Places and their derivatives.
    pub struct Chain {
        output first: f64 = 0.0, "x", "x", unit::RADIAN, "Place.";
        output second: f64 = 0.0, "dx", "x", unit::RADIAN_PER_SECOND, "Rate.", derivative_of = "x";
        local third: f64 = 0.0, "ddx", "x", unit::RADIAN_PER_SECOND_SQUARED, "Rate's rate.", derivative_of = "dx";
    }
}
unit_of!(Chained, Chain, head());

variables! {
    /// A place and its rate, nothing else.
    pub struct Pair {
        output first: f64 = 0.0, "x", "x", unit::RADIAN, "Place.";
        output second: f64 = 0.0, "dx", "x", unit::RADIAN_PER_SECOND, "Rate.", derivative_of = "x";
    }
}
unit_of!(Paired, Pair, head());

variables! {
    /// No derivatives, no input that could be interpolated, and units of all sorts.
    pub struct Plain {
        input count: i32 = 0, "n", "n", unit::HERTZ, "An integer has no unit.";
        parameter weight: f64 = 1.0, "m", "m", GRAM, "With a factor.";
        parameter other: f64 = 1.0, "m2", "m", GRAM, "Again.";
        parameter share: f64 = 1.0, "s", "s", unit::ONE, "A number.", min = 0.0, max = 1.0;
        output place: f64 = 0.0, "u", "u", unit::PIXEL, "Nothing of SI.";
        output any: f64 = 0.0, "any", "a", unit::ANY, "Whatever comes.";
    }
}
unit_of!(Plainly, Plain, head());

#[test]
fn value_orders_of_derivatives_of_outputs() {
    let order =
        |xml: String| xml.split(" maxOutputDerivativeOrder=\"").nth(1).map(|rest| rest[..1].to_owned());
    assert_eq!(order(Unit::of::<Chained>().xml()).as_deref(), Some("2"));
    assert_eq!(order(Unit::of::<Paired>().xml()).as_deref(), Some("1"));
    assert_eq!(order(Unit::of::<Plainly>().xml()), None);
}

#[test]
fn value_inputs_that_can_be_interpolated_are_reals() {
    assert!(Unit::of::<Toy>().xml().contains("canInterpolateInputs=\"true\""));
    for xml in [Unit::of::<Chained>().xml(), Unit::of::<Plainly>().xml()] {
        assert!(!xml.contains("canInterpolateInputs"), "{xml}");
    }
}

#[test]
fn value_units_of_reals_are_defined_once() {
    let xml = Unit::of::<Plainly>().xml();
    let from = xml.find("  <UnitDefinitions>").unwrap();
    let to = xml.find("  <LogCategories>").unwrap();
    let expected = "  <UnitDefinitions>
    <Unit name=\"g\">
      <BaseUnit kg=\"1\" factor=\"0.001\"/>
    </Unit>
    <Unit name=\"1\">
      <BaseUnit/>
    </Unit>
    <Unit name=\"px\">
    </Unit>
  </UnitDefinitions>
";
    assert_eq!(&xml[from..to], expected);
}

#[test]
fn value_outputs_of_the_structure_are_the_outputs() {
    let xml = Unit::of::<Plainly>().xml();
    let expected = "    <Outputs>
      <Unknown index=\"5\" dependencies=\"\"/>
      <Unknown index=\"6\" dependencies=\"\"/>
    </Outputs>
    <InitialUnknowns>
      <Unknown index=\"5\" dependencies=\"\"/>
      <Unknown index=\"6\" dependencies=\"\"/>
    </InitialUnknowns>
";
    assert!(xml.contains(expected), "{xml}");
}

#[test]
fn value_the_notation_lists_each_variable_under_its_heading() {
    let expected = "## a_unit

A unit.

### Inputs

| name | symbol | unit | start | meaning |
|---|---|---|---|---|
| `n` | n |  | 0 | An integer has no unit. |

### Outputs

| name | symbol | unit | start | meaning |
|---|---|---|---|---|
| `u` | u | px |  | Nothing of SI. |
| `any` | a |  |  | Whatever comes. |

### Parameters

| name | symbol | unit | start | meaning |
|---|---|---|---|---|
| `m` | m | g | 1 | With a factor. |
| `m2` | m | g | 1 | Again. |
| `s` | s | 1 | 1 | A number. |
";
    assert_eq!(Unit::of::<Plainly>().notation(), expected);
}

#[test]
fn every_identifier_is_a_c_name() {
    let mistakes = |identifier: &'static str| {
        let mut unit = Unit::of::<Plainly>();
        unit.head.identifier = identifier;
        unit.mistakes()
    };
    for identifier in ["a", "_a", "a1", "A_1"] {
        assert!(mistakes(identifier).is_empty(), "{identifier}");
    }
    for identifier in ["", "1a", "a-b", "a b", "ä", "-"] {
        assert_eq!(mistakes(identifier), [format!("identifier {identifier:?}: a C name is needed")]);
    }
}

#[test]
fn every_head_has_a_time_and_a_step() {
    for (stop_time, step_size, right) in [
        (1.0, 0.1, true),
        (0.0, 0.1, false),
        (1.0, 0.0, false),
        (-1.0, 0.1, false),
        (1.0, -0.1, false),
        (f64::NAN, 0.1, false),
        (1.0, f64::NAN, false),
    ] {
        let mut unit = Unit::of::<Plainly>();
        (unit.head.stop_time, unit.head.step_size) = (stop_time, step_size);
        assert_eq!(unit.mistakes().is_empty(), right, "{stop_time} {step_size}: {:?}", unit.mistakes());
    }
}

#[test]
fn every_start_value_lies_within_its_range() {
    use fmi2_export::Kind;
    for (kind, min, max, right) in [
        (Kind::Real(1.0), Some(1.0), None, true),
        (Kind::Real(1.0), None, Some(1.0), true),
        (Kind::Real(1.0), Some(1.0), Some(1.0), true),
        (Kind::Real(0.5), Some(1.0), None, false),
        (Kind::Real(1.5), Some(0.0), Some(1.0), false),
        (Kind::Real(-0.5), Some(0.0), Some(1.0), false),
        (Kind::Real(f64::NAN), None, None, false),
        (Kind::Real(f64::INFINITY), None, None, false),
        (Kind::Integer(2), Some(2.0), Some(2.0), true),
        (Kind::Integer(3), Some(0.0), Some(2.0), false),
        (Kind::Integer(-1), Some(0.0), None, false),
    ] {
        let mut unit = Unit::of::<Plainly>();
        (unit.variables[1].kind, unit.variables[1].min, unit.variables[1].max) = (kind.clone(), min, max);
        let mistakes = unit.mistakes();
        assert_eq!(mistakes.is_empty(), right, "{kind:?} {min:?} {max:?}: {mistakes:?}");
        assert!(right || mistakes[0].starts_with("variable m: start value "), "{mistakes:?}");
    }
}

#[test]
fn every_name_is_one() {
    for (name, right) in [("m", true), ("a name", true), ("", false), ("a\tb", false), ("\n", false)] {
        let mut unit = Unit::of::<Plainly>();
        unit.variables[1].name = name;
        let expected: &[String] = &[format!("variable {name:?}: not a legal name")];
        assert_eq!(unit.mistakes(), if right { &[] } else { expected });
    }
}

#[test]
fn every_circle_of_derivatives_is_told() {
    assert!(Unit::of::<Chained>().mistakes().is_empty());
    let told = |of: &'static str, name: &'static str| {
        let mut unit = Unit::of::<Chained>();
        let place = unit.variables.iter().position(|variable| variable.name == name).unwrap();
        unit.variables[place].derivative_of = Some(of);
        (unit.xml().contains("maxOutputDerivativeOrder"), unit.mistakes())
    };
    let (_, mistakes) = told("ddx", "x");
    let circle =
        |name: &str| format!("variable {name}: a derivative of its own, whose derivatives go in a circle");
    assert_eq!(mistakes, ["x", "dx", "ddx"].map(circle));
    // Itself; the others hang on to it.
    let (_, mistakes) = told("dx", "dx");
    assert_eq!(mistakes, [circle("dx")]);
    let (_, mistakes) = told("dx", "x");
    assert_eq!(mistakes, ["x", "dx"].map(circle));
}

// A declaration that panics before there is an instance.
variables! {
    /// Nothing.
    pub struct Nothing {
        input one: f64 = 0.0, "a", "a", unit::ONE, "Nothing.";
    }
}
unit_of!(Broken, Nothing, panic!("no description"));

unsafe extern "C" fn keep(
    environment: *mut c_void,
    _: types::Text,
    status: types::Status,
    category: types::Text,
    message: types::Text,
) {
    // SAFETY: the test below passes its own list; the strings are the unit's.
    unsafe {
        let text = |text| std::ffi::CStr::from_ptr(text).to_str().unwrap().to_owned();
        (*environment.cast::<Vec<_>>()).push((status, text(category), text(message)));
    }
}

#[test]
fn every_panic_before_there_is_an_instance_is_told_if_it_is_asked_for() {
    assert_eq!(Nothing::COUNT, 1);
    for logging in [0, 1] {
        let mut lines: Vec<(types::Status, String, String)> = Vec::new();
        // SAFETY: a non-variadic function in place of a variadic one, as in `common`.
        let logger: types::LoggerCallback = unsafe { std::mem::transmute(keep as *const ()) };
        let callbacks = types::Callbacks {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: (&raw mut lines).cast(),
        };
        // SAFETY: all pointers are null or valid.
        let c = unsafe {
            lifecycle::instantiate::<Broken>(c"one".as_ptr(), 1, c"{}".as_ptr(), &callbacks, logging)
        };
        assert_eq!(c, ptr::null_mut());
        let told = (3, "logStatusError".to_owned(), "fmi2Instantiate: panicked: no description".to_owned());
        assert_eq!(lines, if logging == 1 { vec![told] } else { Vec::new() });
    }
}
