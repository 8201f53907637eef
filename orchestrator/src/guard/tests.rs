//! Threads that are guarded, and what is given up with them.

use super::*;

/// One at a time: [`give_up`] has the rows of all threads written.
static ALONE: Mutex<()> = Mutex::new(());

/// Whether this thread is on the list of those that run, and how often.
fn listed() -> usize {
    let mine = UNIT.with(ptr::from_ref);
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner).iter().filter(|run| run.unit == mine).count()
}

/// Counts how often rows were written.
unsafe fn count(recorder: *const ()) {
    // SAFETY: the tests hand a counter over.
    let counter = unsafe { &*recorder.cast::<Cell<u32>>() };
    counter.set(counter.get() + 1);
}

fn rescue_of(counter: &Cell<u32>, time: &f64) -> Rescue {
    let rows = Waiting { write: count, recorder: ptr::from_ref(counter).cast() };
    Rescue { rows: Some(rows), time }
}

#[test]
fn law_a_run_is_rescued_for_as_long_as_it_lasts() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let (counter, time) = (Cell::new(0), 0.5);
    assert!(listed() == 0 && RESCUE.get().is_none());
    let rescued = Rescued::new(rescue_of(&counter, &time));
    assert!(listed() == 1 && RESCUE.get().is_some());
    drop(rescued);
    assert!(listed() == 0 && RESCUE.get().is_none() && counter.get() == 0, "its own recorder ends it");
    // A unit ends the thread in the midst of a call.
    let rescued = Rescued::new(rescue_of(&counter, &time));
    enter(label("ends its thread"));
    calls(Function::DoStep);
    drop(rescued);
    leave();
    assert!(listed() == 0 && RESCUE.get().is_none() && counter.get() == 1, "the rows that wait are written");
}

#[test]
fn law_a_thread_of_a_run_is_on_the_list_while_it_works_for_it() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let (counter, time) = (Cell::new(0), 0.5);
    let rescued = Rescued::new(rescue_of(&counter, &time));
    let shared = rescue();
    // The run's own thread stays on the list, once.
    let mut within = 9;
    shared.adopt(|| within = listed());
    assert_eq!((within, listed()), (1, 1));
    std::thread::scope(|scope| {
        let other = scope.spawn(|| {
            let before = listed();
            let (mut within, mut has) = (9, false);
            shared.adopt(|| (within, has) = (listed(), RESCUE.get().is_some()));
            (before, within, has, listed(), RESCUE.get().is_some())
        });
        assert_eq!(other.join().expect("ends"), (0, 1, true, 0, false));
    });
    // Where nothing is rescued, nobody is on the list.
    drop(rescued);
    rescue().adopt(|| within = listed());
    assert_eq!((within, listed()), (0, 0));
}

#[test]
fn law_who_does_not_come_back_is_named_and_its_rows_are_written() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let (counter, time) = (Cell::new(0), 0.5);
    let rescued = Rescued::new(rescue_of(&counter, &time));
    let mine = || give_up().into_iter().filter(|told| told.contains("unit sleeper")).collect::<Vec<_>>();
    assert!(mine().is_empty() && counter.get() == 0, "no unit is called");
    within(label("sleeper"), || {
        calls(Function::DoStep);
        assert_eq!(
            mine(),
            [
                "unit sleeper: it does not come back from fmi2DoStep after t = 0.5 s; the rows up to there are kept"
            ]
        );
        let other = std::thread::spawn(|| ()).thread().id();
        assert_eq!(not_back(other), None, "no run of its own");
        assert_eq!(
            not_back(std::thread::current().id()).as_deref(),
            Some("unit sleeper: it does not come back from fmi2DoStep after t = 0.5 s")
        );
        assert_eq!(counter.get(), 1, "nothing is done to it");
        loading(label("sleeper"), || {
            assert!(mine()[0].contains("what its library does when it is loaded or unloaded"));
        });
    });
    assert_eq!((mine().len(), counter.get()), (0, 2));
    drop(rescued);
}
