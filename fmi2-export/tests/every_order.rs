//! The standard's table of legal calls (FMI 2.0 section 4.2.4), each mode against each function.

#![allow(unsafe_code)] // calls the C functions as a master does
use crate::common::{Instance, fmi2, vr};
use std::ptr;

/// The modes in which an instance can be, in the order of the columns below.
const MODES: [&str; 5] = ["instantiated", "initialization", "step", "terminated", "error"];

fn in_mode(mode: &str) -> Instance {
    let toy = Instance::new();
    assert_eq!(toy.setup(0.0, None), 0);
    if mode != "instantiated" {
        assert_eq!(toy.enter(), 0);
    }
    match mode {
        "step" | "terminated" | "error" => assert_eq!(toy.exit(), 0),
        _ => {}
    }
    match mode {
        "terminated" => assert_eq!(toy.terminate(), 0),
        "error" => {
            assert_eq!(toy.set_integer(vr::TROUBLE, 3), 0);
            assert_eq!(toy.step(0.0, 0.1), 3);
        }
        _ => {}
    }
    toy.lines();
    toy
}

type Call = fn(&Instance) -> i32;

#[test]
fn every_call_is_legal_exactly_where_the_standard_says() {
    let table: [(&str, Call, [bool; 5]); 26] = [
        ("fmi2SetDebugLogging", |t| unsafe { fmi2::fmi2SetDebugLogging(t.c, 1, 0, ptr::null()) }, [true; 5]),
        ("fmi2SetupExperiment", |t| t.setup(0.0, None), [true, false, false, false, false]),
        ("fmi2EnterInitializationMode", |t| t.enter(), [true, false, false, false, false]),
        ("fmi2ExitInitializationMode", |t| t.exit(), [false, true, false, false, false]),
        ("fmi2Terminate", |t| t.terminate(), [false, false, true, false, false]),
        ("fmi2Reset", |t| t.reset(), [true; 5]),
        ("fmi2GetReal", |t| t.get_real(vr::X).map_or(3, |_| 0), [false, true, true, true, true]),
        ("fmi2GetInteger", |t| t.get_integer(vr::STEPS).map_or(3, |_| 0), [false, true, true, true, true]),
        ("fmi2GetBoolean", |t| t.get_boolean(vr::MOVED).map_or(3, |_| 0), [false, true, true, true, true]),
        ("fmi2GetString", |t| t.get_string(vr::SAID).map_or(3, |_| 0), [false, true, true, true, true]),
        ("fmi2SetReal, input", |t| t.set_real(vr::V, 1.0), [true, true, true, false, false]),
        ("fmi2SetReal, tunable", |t| t.set_real(vr::GAIN, 1.0), [true, true, true, false, false]),
        ("fmi2SetReal, fixed", |t| t.set_real(vr::X_0, 1.0), [true, true, false, false, false]),
        ("fmi2SetReal, output", |t| t.set_real(vr::X, 1.0), [false; 5]),
        ("fmi2SetInteger", |t| t.set_integer(vr::GEAR, 1), [true, true, true, false, false]),
        ("fmi2SetBoolean", |t| t.set_boolean(vr::ON, 1), [true, true, true, false, false]),
        ("fmi2SetString, fixed", |t| t.set_string(vr::WORD, c"w"), [true, true, false, false, false]),
        ("fmi2GetFMUstate", |t| t.get_state(&mut ptr::null_mut()), [true; 5]),
        ("fmi2FreeFMUstate", |t| t.free_state(&mut ptr::null_mut()), [true; 5]),
        (
            "fmi2GetDirectionalDerivative",
            |t| unsafe {
                let mut out = 0.0;
                fmi2::fmi2GetDirectionalDerivative(t.c, &vr::DX, 1, &vr::V, 1, &1.0, &mut out)
            },
            [false, true, true, true, true],
        ),
        ("fmi2SetRealInputDerivatives", |t| t.rate(vr::V, 1, 1.0), [true, true, true, false, false]),
        (
            "fmi2GetRealOutputDerivatives",
            |t| unsafe {
                fmi2::fmi2GetRealOutputDerivatives(t.c, ptr::null(), 0, ptr::null(), ptr::null_mut())
            },
            [false, false, true, true, true],
        ),
        ("fmi2DoStep", |t| t.step(0.0, 0.1), [false, false, true, false, false]),
        ("fmi2CancelStep", |t| unsafe { fmi2::fmi2CancelStep(t.c) }, [false; 5]),
        (
            "fmi2GetStatus",
            |t| unsafe { fmi2::fmi2GetStatus(t.c, 0, &mut 0) },
            [false, false, true, true, false],
        ),
        (
            "fmi2GetRealStatus",
            |t| unsafe { fmi2::fmi2GetRealStatus(t.c, 2, &mut 0.0) },
            [false, false, true, true, false],
        ),
    ];
    for (name, call, legal) in table {
        for (mode, legal) in MODES.into_iter().zip(legal) {
            let toy = in_mode(mode);
            let expected = if legal { 0 } else { 3 };
            assert_eq!(call(&toy), expected, "{name} in {mode}");
            let logged = toy.lines().iter().any(|line| line.2 == "logStatusError");
            assert_eq!(logged, !legal, "{name} in {mode} is logged if and only if it is refused");
        }
    }
}

#[test]
fn every_refused_call_leaves_the_mode_as_it_was() {
    let toy = Instance::new();
    assert_eq!(toy.enter(), 3, "no experiment yet");
    assert_eq!(toy.step(0.0, 0.1), 3);
    for (start, stop) in
        [(f64::NAN, None), (0.0, Some(-1.0)), (f64::INFINITY, None), (0.0, Some(f64::INFINITY))]
    {
        assert_eq!(toy.setup(start, stop), 3);
    }
    assert_eq!(toy.setup(0.0, Some(1.0)), 0);
    assert_eq!(toy.exit(), 3);
    assert_eq!(toy.enter(), 0);
    assert_eq!(toy.step(0.0, 0.1), 3);
    assert_eq!(toy.enter(), 3);
    assert_eq!(toy.exit(), 0);
    assert_eq!(toy.exit(), 3);
    assert_eq!(toy.step(0.0, 0.1), 0);
}

#[test]
fn alone_a_failed_get_in_initialisation_can_be_mended() {
    let toy = Instance::new();
    assert_eq!(toy.setup(0.0, None) + toy.enter(), 0);
    assert_eq!(toy.set_integer(vr::TROUBLE, 4), 0);
    assert_eq!(toy.get_real(vr::X), Err(3));
    assert_eq!(toy.set_integer(vr::TROUBLE, 0), 0);
    assert_eq!(toy.get_real(vr::X), Ok(0.0));
    assert_eq!(toy.exit(), 0);
}
