//! Each C function of the toy unit: what it answers, what it refuses, what it leaves unchanged.

#![allow(unsafe_code)] // calls the C functions as a master does
use crate::common::{Instance, fmi2, vr};
use fmi2_export::abi::types;
use std::ffi::c_void;
use std::ptr;

#[test]
fn alone_a_run_from_start_to_end() {
    let toy = Instance::new();
    assert_eq!(toy.set_real(vr::X_0, 2.0), 0);
    assert_eq!(toy.set_string(vr::WORD, c"grüß"), 0);
    assert_eq!(toy.setup(1.0, Some(2.0)), 0);
    assert_eq!(toy.enter(), 0);
    assert_eq!(toy.get_real(vr::X), Ok(2.0));
    assert_eq!(toy.set_real(vr::V, 4.0), 0);
    assert_eq!(toy.get_real(vr::DX), Ok(4.0), "outputs follow the inputs in initialisation mode");
    assert_eq!(toy.set_integer(vr::GEAR, 2), 0);
    assert_eq!(toy.get_real(vr::DX), Ok(8.0));
    assert_eq!(toy.exit(), 0);
    assert_eq!(toy.get_string(vr::SAID), Ok("grüß".to_owned()));
    assert_eq!(toy.step(1.0, 0.5), 0);
    // 2 + 8 * 0.5; the toy adds noise below 1e-12 * 2^24
    assert!((toy.get_real(vr::X).unwrap() - 6.0).abs() < 2e-5);
    assert_eq!(toy.get_integer(vr::STEPS), Ok(1));
    assert_eq!(toy.get_boolean(vr::MOVED), Ok(1));
    assert_eq!(toy.set_boolean(vr::ON, 0), 0);
    assert_eq!(
        toy.get_real(vr::DX),
        Ok(8.0),
        "a get before the next step answers the last communication point"
    );
    assert_eq!(toy.step(1.5, 0.5), 0);
    assert_eq!(toy.get_real(vr::DX), Ok(0.0));
    assert_eq!(toy.terminate(), 0);
    assert_eq!(toy.get_integer(vr::STEPS), Ok(2));
    assert_eq!(toy.reset(), 0);
    assert_eq!(toy.setup(0.0, None), 0);
    assert_eq!(toy.enter(), 0);
    assert_eq!(toy.get_real(vr::X), Ok(0.0));
    assert_eq!(toy.get_string(vr::WORD), Ok("hello".to_owned()));
}

#[test]
fn every_instantiation_that_must_fail_does_and_says_why() {
    let guid = Instance::guid();
    for (name, kind, guid, why) in [
        (None, 1, Some(guid.as_c_str()), "instanceName"),
        (Some(c" "), 1, Some(guid.as_c_str()), "instanceName"),
        (Some(c"one"), 0, Some(guid.as_c_str()), "co-simulation"),
        (Some(c"one"), 1, None, "null pointer"),
        (Some(c"one"), 1, Some(c"{0-0}"), "{0-0}"),
    ] {
        let toy = Instance::try_new(name, kind, guid, true);
        assert!(toy.c.is_null());
        assert!(toy.error().contains(why), "{why}");
        assert!(Instance::try_new(name, kind, guid, false).lines().is_empty(), "nothing is logged unasked");
    }
    unsafe {
        let bare = fmi2::fmi2Instantiate(c"one".as_ptr(), 1, guid.as_ptr(), ptr::null(), ptr::null(), 0, 1);
        assert!(!bare.is_null(), "callbacks may be missing");
        assert_eq!(fmi2::fmi2DoStep(bare, 0.0, 1.0, 0), 3);
        fmi2::fmi2FreeInstance(bare);
        fmi2::fmi2FreeInstance(ptr::null_mut());
        assert_eq!(fmi2::fmi2Reset(ptr::null_mut()), 3);
    }
}

#[test]
fn every_refused_set_names_the_variable_and_changes_nothing() {
    let toy = Instance::ready();
    let refused = |status, words: &[&str]| {
        assert_eq!(status, 3);
        let message = toy.error();
        for word in words {
            assert!(message.contains(word), "{message:?} lacks {word:?}");
        }
    };
    refused(toy.set_real(vr::V, f64::NAN), &["fmi2SetReal", "v = NaN"]);
    refused(toy.set_real(vr::V, f64::INFINITY), &["v = inf"]);
    refused(toy.set_real(vr::V, 101.0), &["v = 101", "-100 to 100"]);
    refused(toy.set_integer(vr::GEAR, 6), &["gear = 6", "0 to 5"]);
    refused(toy.set_boolean(vr::ON, 2), &["on = 2"]);
    refused(toy.set_real(vr::X, 1.0), &["x is an output"]);
    refused(toy.set_real(vr::X_0, 1.0), &["x_0 is a fixed parameter", "step complete"]);
    refused(toy.set_real(vr::GEAR, 1.0), &["gear", "Integer"]);
    refused(toy.set_real(vr::NONE, 1.0), &["13 does not exist"]);
    refused(toy.set_string(vr::WORD, c"late"), &["word is a fixed parameter"]);
    assert_eq!(toy.set_real(vr::GAIN, 3.0), 0, "a tunable parameter may change");

    let two = [vr::V, vr::DRAG];
    refused(unsafe { fmi2::fmi2SetReal(toy.c, two.as_ptr(), 2, [1.0, -1.0].as_ptr()) }, &["drag = -1"]);
    assert_eq!(toy.get_real(vr::V), Ok(0.0), "all or nothing");

    unsafe {
        refused(fmi2::fmi2SetReal(toy.c, ptr::null(), 1, &1.0), &["vr is a null pointer"]);
        refused(fmi2::fmi2SetReal(toy.c, &vr::V, 1, ptr::null()), &["value is a null pointer"]);
        refused(fmi2::fmi2GetReal(toy.c, &vr::V, 1, ptr::null_mut()), &["value is a null pointer"]);
        for length in [usize::MAX, isize::MAX as usize, isize::MAX as usize / 4 + 1] {
            refused(fmi2::fmi2SetReal(toy.c, &vr::V, length, &1.0), &["impossible length"]);
        }
        assert_eq!(fmi2::fmi2SetReal(toy.c, ptr::null(), 0, ptr::null()), 0);
        assert_eq!(fmi2::fmi2GetReal(toy.c, ptr::null(), 0, ptr::null_mut()), 0);
    }
    assert!(toy.lines().is_empty());

    let fresh = Instance::new();
    unsafe {
        assert_eq!(fmi2::fmi2SetString(fresh.c, &vr::WORD, 1, &ptr::null()), 3);
        assert!(fresh.error().contains("word"));
        assert_eq!(fmi2::fmi2SetString(fresh.c, &vr::WORD, 1, &c"\xff".as_ptr()), 3);
        assert!(fresh.error().contains("UTF-8"));
    }
}

#[test]
fn every_refused_get_writes_nothing() {
    let toy = Instance::ready();
    let mut values = [7.0, 7.0];
    let status = unsafe { fmi2::fmi2GetReal(toy.c, [vr::V, vr::ON].as_ptr(), 2, values.as_mut_ptr()) };
    assert_eq!((status, values), (3, [7.0, 7.0]));
    assert!(toy.error().contains("on (value reference 2) is of type Boolean"));
    assert_eq!(toy.get_integer(vr::X), Err(3));
    assert_eq!(toy.get_boolean(vr::X), Err(3));
    assert_eq!(toy.get_string(vr::X), Err(3));
}

#[test]
fn every_step_that_makes_no_sense_is_refused_and_the_next_one_works() {
    let toy = Instance::new();
    assert_eq!(toy.setup(0.0, Some(1.0)), 0);
    assert_eq!(toy.enter() + toy.exit(), 0);
    for (from, size, why) in [
        (0.0, 0.0, "communicationStepSize = 0: a positive number is needed"),
        (0.0, -0.1, "communicationStepSize = -0.1: a positive number is needed"),
        (0.0, f64::NAN, "communicationStepSize = NaN: a positive number is needed"),
        (0.0, f64::INFINITY, "communicationStepSize = inf: a positive number is needed"),
        (f64::NAN, 0.1, "currentCommunicationPoint = NaN"),
        (0.1, 0.1, "the instance is at t = 0 s"),
        (0.0, 1.1, "past stopTime = 1 s"),
    ] {
        assert_eq!(toy.step(from, size), 3);
        let message = toy.error();
        assert!(message.contains(why), "{message}");
    }
    assert_eq!(toy.step(0.0, 0.3), 0);
    assert_eq!(toy.step(0.1 + 0.2, 0.7 + 1e-12), 0, "rounding of the master is let through");
}

#[test]
fn alone_outputs_at_the_start_are_computed_once_for_what_was_set() {
    let toy = Instance::new();
    assert_eq!(toy.setup(0.0, None) + toy.enter(), 0);
    let starts = || toy.lines().iter().filter(|line| line.3.starts_with("starts at")).count();
    assert_eq!(starts(), 0);
    assert_eq!(toy.get_real(vr::X), Ok(0.0));
    assert_eq!(starts(), 1);
    assert_eq!(toy.get_real(vr::X), Ok(0.0));
    assert_eq!(unsafe { fmi2::fmi2SetReal(toy.c, ptr::null(), 0, ptr::null()) }, 0);
    assert_eq!(toy.get_real(vr::DX), Ok(0.0));
    assert_eq!(starts(), 0, "nothing was set");
    assert_eq!(toy.set_real(vr::X_0, 2.0), 0);
    assert_eq!(starts(), 0, "nobody has asked");
    assert_eq!(toy.get_real(vr::X), Ok(2.0));
    assert_eq!(toy.exit(), 0);
    assert_eq!(starts(), 1);
    assert_eq!(toy.set_real(vr::GAIN, 2.0), 0);
    assert_eq!(toy.get_real(vr::X), Ok(2.0));
    assert_eq!(starts(), 0, "it has begun");
}

#[test]
fn every_failure_inside_the_model_stays_inside() {
    for (trouble, why) in [(1, "panicked: trouble 1"), (2, "x = NaN"), (3, "variable gain = 1: less")] {
        let toy = Instance::ready();
        assert_eq!(toy.set_integer(vr::TROUBLE, trouble), 0);
        assert_eq!(toy.step(0.0, 0.1), 3);
        let message = toy.error();
        assert!(message.contains(why), "{message}");
        assert_eq!(toy.step(0.0, 0.1), 3);
        assert!(toy.error().contains("\"error\""));
        assert_eq!(toy.set_real(vr::V, 1.0), 3);
        assert_eq!(toy.terminate(), 3);
        assert!(toy.get_integer(vr::TROUBLE).is_ok(), "values can still be read");
        assert_eq!(toy.reset(), 0);
        assert_eq!(toy.setup(0.0, None) + toy.enter() + toy.exit() + toy.step(0.0, 0.1), 0);
    }
    for (trouble, why) in [(4, "no start"), (5, "panicked: no start at all")] {
        let toy = Instance::new();
        assert_eq!(toy.set_integer(vr::TROUBLE, trouble), 0);
        assert_eq!(toy.setup(0.0, None) + toy.enter(), 0);
        assert_eq!(toy.exit(), 3);
        assert!(toy.error().contains(why));
        assert_eq!(toy.step(0.0, 0.1), 3);
        assert!(toy.error().contains("not allowed in the state \"error\""));
        assert_eq!(toy.set_integer(vr::TROUBLE, 0), 3, "nothing can be set any more");
        assert_eq!(toy.exit() + toy.enter() + toy.setup(0.0, None) + toy.terminate(), 12);
        assert_eq!(toy.get_integer(vr::TROUBLE), Ok(trouble), "values can still be read");
        assert_eq!(toy.reset(), 0);
        assert_eq!(toy.setup(0.0, None) + toy.enter() + toy.exit() + toy.step(0.0, 0.1), 0);
    }
}

#[test]
fn every_tolerance_that_cant_be_is_refused_where_it_is_defined() {
    for tolerance in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        let toy = Instance::new();
        let setup = |defined| unsafe { fmi2::fmi2SetupExperiment(toy.c, defined, tolerance, 0.0, 0, 0.0) };
        assert_eq!(setup(1), 3, "{tolerance}");
        assert!(toy.error().contains(&format!("argument tolerance = {tolerance}: a positive number")));
        assert_eq!(toy.enter(), 3, "nothing is set up");
        assert_eq!(setup(0), 0, "not looked at where it isn't defined");
        assert_eq!(toy.enter() + toy.exit(), 0);
    }
    let toy = Instance::new();
    assert_eq!(unsafe { fmi2::fmi2SetupExperiment(toy.c, 1, 1e-6, 0.0, 0, 0.0) }, 0);
}

#[test]
fn alone_input_derivatives_serve_one_step() {
    let toy = Instance::ready();
    assert_eq!(toy.rate(vr::V, 1, 200.0), 0);
    assert_eq!(toy.step(0.0, 0.1), 0);
    let first = toy.get_real(vr::X).unwrap();
    assert!((first - 1.0).abs() < 2e-5, "0.5 * 200 * 0.1^2, and the toy's noise: {first}");
    assert_eq!(toy.step(0.1, 0.1), 0);
    assert!((toy.get_real(vr::X).unwrap() - first).abs() < 2e-5, "forgotten after the step");
    // The last one said counts.
    assert_eq!(toy.rate(vr::V, 1, 300.0) + toy.rate(vr::V, 1, 200.0), 0);
    assert_eq!(toy.step(0.2, 0.1), 0);
    assert!((toy.get_real(vr::X).unwrap() - 2.0 * first).abs() < 4e-5);
    for (reference, order, value) in [
        (vr::V, 2, 1.0),
        (vr::V, 0, 1.0),
        (vr::V, 1, f64::NAN),
        (vr::X, 1, 1.0),
        (vr::GEAR, 1, 1.0),
        (99, 1, 1.0),
    ] {
        assert_eq!(toy.rate(reference, order, value), 3);
        toy.error();
    }
    unsafe {
        // x is declared with its rate dx; dx has none.
        let (mut rate, mut speed) = (f64::NAN, f64::NAN);
        assert_eq!(fmi2::fmi2GetRealOutputDerivatives(toy.c, &vr::X, 1, &1, &mut rate), 0);
        assert_eq!(fmi2::fmi2GetReal(toy.c, &vr::DX, 1, &mut speed), 0);
        assert_eq!(rate, speed);
        // What isn't provided is discarded, what is no output is an error.
        for (reference, order, status) in
            [(vr::X, 0, 2), (vr::X, 2, 2), (vr::X, i32::MAX, 2), (vr::DX, 1, 2), (vr::V, 1, 3), (99, 1, 3)]
        {
            assert_eq!(fmi2::fmi2GetRealOutputDerivatives(toy.c, &reference, 1, &order, &mut rate), status);
        }
        assert_eq!(
            fmi2::fmi2GetRealOutputDerivatives(toy.c, ptr::null(), 0, ptr::null(), ptr::null_mut()),
            0
        );
    }
}

#[test]
fn alone_directional_derivatives_are_weighted_sums() {
    let toy = Instance::ready();
    assert_eq!(toy.set_real(vr::GAIN, 3.0), 0);
    let mut change = 0.0;
    let derivative = |unknown: u32, knowns: &[u32], seed: &[f64], out: &mut f64| unsafe {
        fmi2::fmi2GetDirectionalDerivative(
            toy.c,
            &unknown,
            1,
            knowns.as_ptr(),
            knowns.len(),
            seed.as_ptr(),
            out,
        )
    };
    assert_eq!(derivative(vr::DX, &[vr::V, vr::X], &[2.0, 5.0], &mut change), 0);
    assert_eq!(change, 6.0);
    assert_eq!(derivative(vr::X, &[vr::V], &[1.0], &mut change), 3);
    assert!(toy.error().contains("the derivative of x with respect to v is not provided"));
    assert_eq!(derivative(vr::DX, &[vr::V], &[f64::NAN], &mut change), 3);
    assert_eq!(derivative(vr::STEPS, &[vr::V], &[1.0], &mut change), 3);
    assert_eq!(change, 6.0, "untouched by refused calls");
}

#[test]
fn every_status_question_is_answered_or_discarded() {
    let toy = Instance::ready();
    assert_eq!(toy.step(0.0, 0.25), 0);
    let (mut status, mut real, mut boolean, mut integer, mut text) = (9, 0.0, 9, 9, ptr::null());
    unsafe {
        assert_eq!(fmi2::fmi2GetStatus(toy.c, 0, &mut status), 0);
        assert_eq!(fmi2::fmi2GetRealStatus(toy.c, 2, &mut real), 0);
        assert_eq!(fmi2::fmi2GetBooleanStatus(toy.c, 3, &mut boolean), 0);
        assert_eq!((status, real, boolean), (0, 0.25, 0));
        assert_eq!(fmi2::fmi2GetIntegerStatus(toy.c, 0, &mut integer), 2);
        assert_eq!(fmi2::fmi2GetStringStatus(toy.c, 1, &mut text), 2);
        assert_eq!(fmi2::fmi2GetStatus(toy.c, 77, &mut status), 2);
        assert_eq!(fmi2::fmi2GetStatus(toy.c, 0, ptr::null_mut()), 3);
        assert_eq!(fmi2::fmi2CancelStep(toy.c), 3);
    }
    assert!(toy.lines().iter().any(|line| line.1 == 2 && line.2 == "logStatusDiscard"));
}

#[test]
fn alone_the_log_is_filtered_and_escaped() {
    let toy = Instance::ready();
    let lines = toy.lines();
    let (name, status, category, message) = &lines[0];
    assert_eq!((name.as_str(), *status, category.as_str()), ("one", 0, "logToy"));
    assert_eq!(message, "starts at 0 s, 100 %% ##1");
    let select =
        |on, names: &[*const _]| unsafe { fmi2::fmi2SetDebugLogging(toy.c, on, names.len(), names.as_ptr()) };
    assert_eq!(select(1, &[c"logStatusError".as_ptr()]), 0);
    assert_eq!(toy.step(0.0, 0.1), 0);
    assert!(toy.lines().is_empty());
    assert_eq!(select(1, &[c"logNothing".as_ptr()]), 3);
    assert!(toy.error().contains("logNothing"));
    assert_eq!(select(1, &[ptr::null()]), 3);
    assert!(toy.error().contains("categories is a null pointer"));
    assert_eq!(select(0, &[]), 0);
    assert_eq!(toy.step(0.0, 0.1), 3);
    assert!(toy.lines().is_empty());
}

/// Calls back into the instance that is logging, and keeps the answer.
unsafe extern "C" fn call_back(
    environment: *mut c_void,
    _: types::Text,
    _: types::Status,
    _: types::Text,
    _: types::Text,
) {
    // SAFETY: the test below passes its own pair.
    unsafe {
        let (c, answer) = &mut *environment.cast::<(types::Component, Option<i32>)>();
        if !c.is_null() {
            *answer = Some(fmi2::fmi2Reset(*c));
            fmi2::fmi2FreeInstance(*c);
        }
    }
}

#[test]
fn alone_a_call_from_within_the_log_is_refused() {
    let mut environment: (types::Component, Option<i32>) = (ptr::null_mut(), None);
    // SAFETY: as in `common`.
    let logger: types::LoggerCallback = unsafe { std::mem::transmute(call_back as *const ()) };
    let callbacks = types::Callbacks {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: (&raw mut environment).cast(),
    };
    let guid = Instance::guid();
    unsafe {
        let c = fmi2::fmi2Instantiate(c"one".as_ptr(), 1, guid.as_ptr(), ptr::null(), &callbacks, 0, 1);
        (*callbacks.environment.cast::<(types::Component, Option<i32>)>()).0 = c;
        assert_eq!(fmi2::fmi2DoStep(c, 0.0, 1.0, 0), 3, "logs, and the log calls back");
        assert_eq!((*callbacks.environment.cast::<(types::Component, Option<i32>)>()).1, Some(3));
        assert_eq!(fmi2::fmi2Reset(c), 0, "the instance lives on");
        fmi2::fmi2FreeInstance(c);
    }
}
