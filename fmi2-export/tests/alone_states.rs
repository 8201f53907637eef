//! Saved states of the toy unit: restored to the bit, here and elsewhere; damaged and foreign ones refused.

#![allow(unsafe_code)] // calls the C functions as a master does
use crate::common::{Instance, fmi2, vr};
use std::ffi::c_void;
use std::ptr;

/// The outputs after `count` more steps, as bits.
fn go_on(toy: &Instance, mut from: f64, count: usize) -> Vec<u64> {
    let mut seen = Vec::new();
    for _ in 0..count {
        assert_eq!(toy.step(from, 0.01), 0, "{:?}", toy.lines());
        from += 0.01;
        seen.extend([vr::X, vr::DX].map(|reference| toy.get_real(reference).unwrap().to_bits()));
    }
    seen
}

#[test]
fn law_a_restored_state_goes_on_as_before_to_the_bit() {
    let toy = Instance::ready();
    assert_eq!(toy.set_real(vr::V, 3.0), 0);
    go_on(&toy, 0.0, 7);
    assert_eq!(toy.rate(vr::V, 1, 5.0), 0, "a pending input derivative belongs to the state");
    let mut state = ptr::null_mut();
    assert_eq!(toy.get_state(&mut state), 0);
    let bytes = toy.serialize(state).unwrap();
    let time = (0..7).fold(0.0, |time, _| time + 0.01);
    let expected = go_on(&toy, time, 5);
    assert_eq!(toy.set_real(vr::V, -1.0), 0);

    assert_eq!(toy.set_state(state), 0);
    assert_eq!(toy.get_real(vr::V), Ok(3.0));
    assert_eq!(go_on(&toy, time, 5), expected, "in the same instance");

    let other = Instance::new();
    let mut copy = other.deserialize(&bytes).unwrap();
    assert_eq!(other.set_state(copy), 0);
    assert_eq!(other.serialize(copy).unwrap(), bytes, "the same bytes afterwards");
    assert_eq!(go_on(&other, time, 5), expected, "in another instance, from bytes");

    let third = Instance::new();
    assert_eq!(third.set_state(state), 0);
    assert_eq!(go_on(&third, time, 5), expected, "in another instance, from the handle");
    assert_eq!(other.free_state(&mut copy), 0);
    assert!(copy.is_null());
}

#[test]
fn every_state_that_cannot_be_used_is_refused() {
    let toy = Instance::ready();
    let mut state = ptr::null_mut();
    assert_eq!(toy.get_state(&mut state), 0);
    let bytes = toy.serialize(state).unwrap();
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert_eq!(toy.deserialize(&damaged), Err(3), "byte {at}");
        assert_eq!(toy.deserialize(&bytes[..at]), Err(3), "{at} bytes");
    }
    toy.lines();
    let longer: Vec<u8> = bytes.iter().copied().chain([0; 100]).collect();
    assert!(toy.deserialize(&longer).is_ok(), "a larger buffer holds the same state");

    let mut small = vec![7_u8; bytes.len() - 1];
    unsafe {
        assert_eq!(fmi2::fmi2SerializeFMUstate(toy.c, state, small.as_mut_ptr().cast(), small.len()), 3);
        assert!(small.iter().all(|byte| *byte == 7), "nothing was written");
        assert!(toy.error().contains("the buffer has"));
        assert_eq!(fmi2::fmi2SerializeFMUstate(toy.c, state, ptr::null_mut(), 999), 3);
        assert_eq!(fmi2::fmi2SerializedFMUstateSize(toy.c, state, ptr::null_mut()), 3);
        assert_eq!(
            fmi2::fmi2DeSerializeFMUstate(toy.c, bytes.as_ptr().cast(), bytes.len(), ptr::null_mut()),
            3
        );
        assert_eq!(fmi2::fmi2GetFMUstate(toy.c, ptr::null_mut()), 3);
        assert_eq!(fmi2::fmi2FreeFMUstate(toy.c, ptr::null_mut()), 0);
    }
    let mut none: *mut c_void = ptr::null_mut();
    assert_eq!(toy.free_state(&mut none), 0);
    assert_eq!(toy.set_state(none), 3);
    let mut foreign = ptr::without_provenance_mut(0x1001);
    assert_eq!(toy.set_state(foreign), 3);
    assert_eq!(toy.free_state(&mut foreign), 3);
    let mut again = state;
    assert_eq!(toy.free_state(&mut state), 0);
    assert_eq!(toy.free_state(&mut again), 3, "freed twice");
    assert_eq!(toy.set_state(again), 3, "used after it was freed");
}

#[test]
fn alone_a_state_is_overwritten_in_place_and_goes_with_its_instance() {
    let toy = Instance::ready();
    let mut state = ptr::null_mut();
    assert_eq!(toy.get_state(&mut state), 0);
    let handle = state;
    go_on(&toy, 0.0, 1);
    assert_eq!(toy.get_state(&mut state), 0);
    assert_eq!(state, handle);
    let other = Instance::new();
    assert_eq!(other.set_state(state), 0);
    assert_eq!(other.get_integer(vr::STEPS), Ok(1), "the newer content");
    drop(toy);
    assert_eq!(other.set_state(state), 3, "freed with its owner");
    assert_eq!(other.free_state(&mut state), 3);
}

#[test]
fn alone_a_promise_never_to_go_back_may_be_broken_and_is_told_once() {
    let toy = Instance::ready();
    let mut states = [ptr::null_mut(); 3];
    for (at, state) in states.iter_mut().enumerate() {
        assert_eq!(toy.get_state(state), 0);
        let step = if at == 1 { Instance::step_and_forget } else { Instance::step };
        assert_eq!(step(&toy, 0.25 * at as f64, 0.25), 0);
    }
    let told = || -> Vec<String> {
        toy.lines().into_iter().filter(|line| line.2 == "logStatusWarning").map(|line| line.3).collect()
    };
    assert_eq!(toy.set_state(states[1]), 0, "the point itself is not prior to it");
    assert!(told().is_empty());
    assert_eq!(toy.set_state(states[0]), 0);
    let text = told().concat();
    assert!(text.contains("t = 0 s") && text.contains("before 0.25 s"), "{text}");
    assert_eq!(toy.get_integer(vr::STEPS), Ok(0), "it is restored");
    assert_eq!(toy.step_and_forget(0.0, 0.25), 0);
    assert_eq!(toy.step_and_forget(0.25, 0.25), 0);
    assert_eq!(toy.set_state(states[0]), 0);
    assert!(told().is_empty(), "not said again");
    assert_eq!(toy.step(0.0, 0.1), 0);
}

#[test]
fn alone_a_promise_never_to_go_back_is_kept_up_to_rounding() {
    // A state at `saved`, a promise at `limit`, which rounding lets pass for the same time.
    let warned = |start: f64, saved: f64, limit: f64| {
        let toy = Instance::new();
        assert_eq!(toy.setup(start, None) + toy.enter() + toy.exit(), 0);
        if saved > start {
            assert_eq!(toy.step(start, saved - start), 0);
        }
        let mut state = ptr::null_mut();
        assert_eq!(toy.get_state(&mut state), 0);
        if limit - saved > 1e-6 * limit {
            assert_eq!(toy.step(saved, limit - saved), 0);
        }
        assert_eq!(toy.step_and_forget(limit, 0.25), 0, "{limit}");
        toy.lines();
        assert_eq!(toy.set_state(state), 0);
        toy.lines().iter().any(|line| line.2 == "logStatusWarning")
    };
    assert!(!warned(0.0, 0.0, 0.0), "the very point");
    assert!(!warned(999.0, 1000.0 - 1e-7, 1000.0), "rounding");
    assert!(warned(0.0, 1e-3 - 1e-7, 1e-3), "a ten-thousandth of the time");
    assert!(!warned(-1.0, 0.0, 0.0));
}

#[test]
fn alone_a_failed_step_can_be_taken_back() {
    let toy = Instance::ready();
    let mut state = ptr::null_mut();
    assert_eq!(toy.get_state(&mut state), 0);
    assert_eq!(toy.set_integer(vr::TROUBLE, 1), 0);
    assert_eq!(toy.step(0.0, 0.1), 3);
    assert_eq!(toy.set_state(state), 0);
    assert_eq!(toy.step(0.0, 0.1), 0);
}

#[test]
fn law_instances_in_threads_do_not_touch_each_other() {
    let alone: Vec<_> = (0..8).map(|number| run(f64::from(number))).collect();
    let threads: Vec<_> = (0..8).map(|number| std::thread::spawn(move || run(f64::from(number)))).collect();
    let together: Vec<_> = threads.into_iter().map(|thread| thread.join().unwrap()).collect();
    assert_eq!(alone, together);

    // One instance may also wander from thread to thread.
    let toy = Instance::ready();
    let toy = std::thread::spawn(move || {
        go_on(&toy, 0.0, 2);
        toy
    });
    assert_eq!(toy.join().unwrap().get_integer(vr::STEPS), Ok(2));
}

/// A run that saves and restores all the time.
fn run(velocity: f64) -> Vec<u64> {
    let toy = Instance::ready();
    assert_eq!(toy.set_real(vr::V, velocity), 0);
    let (mut seen, mut time, mut state) = (Vec::new(), 0.0, ptr::null_mut());
    for _ in 0..200 {
        assert_eq!(toy.get_state(&mut state), 0);
        go_on(&toy, time, 2);
        assert_eq!(toy.set_state(state), 0);
        seen.extend(go_on(&toy, time, 1));
        time += 0.01;
    }
    seen
}
