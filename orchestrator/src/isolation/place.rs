//! On which processors a thread and the processes of its units run, while it steps them one after the other.
//!
//! *Apart*: wherever the system puts them. Where each has a processor of its own, both sides look for each other's word, which comes
//! within a microsecond. Waking a process that sleeps on another processor takes some 40 µs. *Together*: all on one processor. Then a
//! hand-over is a switch from one process to another, some 5 µs however many units there are, and others that compute are not in the
//! way. Which one is better depends on the machine and on what else it does, so both are tried, again and again.

use std::cell::RefCell;
use std::marker::PhantomData;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Where an exchange is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Apart,
    Together,
}

/// Exchanges after a change that are not counted: those who sleep are woken from afar, and memory is cold.
const WARM: u32 = 4;
/// Exchanges of a trial. At 40 µs each a trial takes less than a millisecond, one part in a hundred of [`HELD`].
const TRIAL: u32 = 16;
/// Exchanges between looks at the clock while a way is held.
const BETWEEN: u32 = 64;
/// So long the better way is held: what else the machine does changes in such times.
const HELD: Duration = Duration::from_millis(100);
/// Sharing a processor must take less than so much of the time: where steps are long nothing is to be gained, and a unit that
/// could run elsewhere should be free to.
const WORTH: f64 = 0.9;

/// Which way is the better one, from what exchanges took.
struct Choice {
    way: Way,
    /// Seconds an exchange, of the last trial or the time that it was held.
    took: [Option<f64>; 2],
    state: State,
    left: u32,
    made: u32,
    since: Instant,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Warm,
    Trial,
    Held,
}

impl Choice {
    fn new(now: Instant) -> Self {
        Self { way: Way::Apart, took: [None; 2], state: State::Warm, left: WARM, made: 0, since: now }
    }

    /// One more exchange was made; the clock is asked only now and then.
    fn next(&mut self, now: impl Fn() -> Instant) {
        self.left -= 1;
        if self.left > 0 {
            return;
        }
        let now = now();
        match self.state {
            State::Warm => {
                let known = self.took.iter().all(Option::is_some);
                // Known both: this is the better one of the two, and was changed to.
                let state = if known && self.way == self.better() { State::Held } else { State::Trial };
                self.begin(state, if state == State::Held { BETWEEN } else { TRIAL }, now);
            }
            State::Trial => {
                self.took[self.way as usize] = Some((now - self.since).as_secs_f64() / f64::from(TRIAL));
                if self.took.iter().all(Option::is_some) {
                    let better = self.better();
                    if better == self.way {
                        self.begin(State::Held, BETWEEN, now);
                    } else {
                        self.change(now);
                    }
                } else {
                    self.change(now);
                }
            }
            State::Held => {
                self.made += BETWEEN;
                self.left = BETWEEN;
                if now - self.since >= HELD {
                    self.took[self.way as usize] =
                        Some((now - self.since).as_secs_f64() / f64::from(self.made));
                    self.took[1 - self.way as usize] = None;
                    self.change(now);
                }
            }
        }
    }

    fn begin(&mut self, state: State, left: u32, now: Instant) {
        (self.state, self.left, self.made, self.since) = (state, left, 0, now);
    }

    fn change(&mut self, now: Instant) {
        self.way = if self.way == Way::Apart { Way::Together } else { Way::Apart };
        self.begin(State::Warm, WARM, now);
    }

    fn better(&self) -> Way {
        match self.took {
            [Some(apart), Some(together)] if together < WORTH * apart => Way::Together,
            _ => Way::Apart,
        }
    }
}

/// Processors on which a thread may run.
pub(super) type Mask = libc::cpu_set_t;

/// Those of a thread, 0 for this one; `None` where the system does not say.
pub(super) fn mask(thread: i32) -> Option<Mask> {
    // SAFETY: plain data, of which the length is given.
    unsafe {
        let mut mask = std::mem::zeroed();
        (libc::sched_getaffinity(thread, size_of::<Mask>(), &raw mut mask) == 0).then_some(mask)
    }
}

/// Has a thread run on these only; whether it will.
pub(super) fn put(thread: i32, mask: &Mask) -> bool {
    // SAFETY: plain data, of which the length is given.
    unsafe { libc::sched_setaffinity(thread, size_of::<Mask>(), mask) == 0 }
}

/// A processor alone.
pub(super) fn only(processor: usize) -> Mask {
    // SAFETY: plain data; the processor is one of those that the mask has room for.
    unsafe {
        let mut mask: Mask = std::mem::zeroed();
        libc::CPU_SET(processor, &mut mask);
        mask
    }
}

/// The one that this thread is on.
fn here() -> Option<usize> {
    // SAFETY: a question.
    let processor = usize::try_from(unsafe { libc::sched_getcpu() }).ok()?;
    (processor < 8 * size_of::<Mask>()).then_some(processor)
}

/// A thread that steps units.
struct Place {
    choice: Choice,
    /// Where it usually may run, and where it is bound to now.
    usual: Mask,
    bound: Option<usize>,
}

thread_local! {
    static PLACE: RefCell<Option<Place>> = const { RefCell::new(None) };
}

/// Processes of units, and threads that step such.
static RUNNING: AtomicUsize = AtomicUsize::new(0);

/// One of those that want a processor.
pub(super) struct Running;

impl Running {
    pub(super) fn new() -> Self {
        RUNNING.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        RUNNING.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Whether all have a processor of their own. Asked for the first time by a thread that is bound to none.
fn room() -> bool {
    static PROCESSORS: OnceLock<usize> = OnceLock::new();
    let processors = PROCESSORS.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from));
    RUNNING.load(Ordering::Relaxed) <= *processors
}

/// While it lives this thread steps units one after the other, and nothing else is done in it that begins threads.
pub(crate) struct Stepping {
    mine: bool,
    _running: Running,
    /// It belongs to its thread.
    _here: PhantomData<*const ()>,
}

impl Stepping {
    pub(crate) fn begin() -> Self {
        let running = Running::new();
        room();
        let mine = PLACE.with_borrow_mut(|place| {
            let Some(usual) = mask(0).filter(|_| place.is_none()) else { return false };
            *place = Some(Place { choice: Choice::new(Instant::now()), usual, bound: None });
            true
        });
        Self { mine, _running: running, _here: PhantomData }
    }
}

impl Drop for Stepping {
    fn drop(&mut self) {
        if self.mine
            && let Some(Place { usual, bound: Some(_), .. }) = PLACE.take()
        {
            put(0, &usual);
        }
    }
}

/// How the next exchange of this thread is to be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wanted {
    /// The processor of the thread, which the unit's process is to share.
    pub(super) processor: Option<usize>,
    /// Who waits looks before it sleeps.
    pub(super) looks: bool,
}

/// See [`Wanted`].
#[inline]
pub(super) fn next() -> Wanted {
    PLACE.with_borrow_mut(|place| match place {
        Some(place) => {
            place.choice.next(Instant::now);
            let processor = match (place.choice.way, place.bound) {
                (Way::Apart, None) => None,
                (Way::Together, Some(processor)) => Some(processor),
                _ => place.change(),
            };
            Wanted { processor, looks: processor.is_none() && room() }
        }
        None => Wanted { processor: None, looks: true },
    })
}

impl Place {
    #[cold]
    fn change(&mut self) -> Option<usize> {
        if self.bound.take().is_some() {
            put(0, &self.usual);
        } else {
            self.bound = here().filter(|processor| put(0, &only(*processor)));
        }
        self.bound
    }
}

#[cfg(test)]
mod tests {
    use super::{
        BETWEEN, Choice, HELD, Ordering, RUNNING, State, Stepping, TRIAL, WARM, Way, here, mask, next,
    };
    use std::cell::Cell;
    use std::time::{Duration, Instant};

    /// Exchanges that take so long, in µs; how many of them were made each way.
    fn exchanges(choice: &mut Choice, clock: &Cell<Instant>, took: [u64; 2], count: u32) -> [u32; 2] {
        let mut made = [0, 0];
        for _ in 0..count {
            made[choice.way as usize] += 1;
            clock.set(clock.get() + Duration::from_micros(took[choice.way as usize]));
            choice.next(|| clock.get());
        }
        made
    }

    #[test]
    fn law_the_faster_way_is_held_and_the_other_one_tried_now_and_then() {
        for (took, better) in [
            ([40, 5], Way::Together),
            ([1, 5], Way::Apart),
            // Long steps: next to nothing is gained.
            ([1040, 1005], Way::Apart),
        ] {
            let clock = Cell::new(Instant::now());
            let mut choice = Choice::new(clock.get());
            let first = exchanges(&mut choice, &clock, took, 2 * (WARM + TRIAL) + WARM);
            assert!(first.iter().all(|made| *made >= WARM + TRIAL), "both are tried: {first:?}");
            assert!(choice.way == better && choice.state != State::Trial, "{took:?}");
            let second = 1_000_000 / took[better as usize] as u32;
            let made = exchanges(&mut choice, &clock, took, second);
            // Ten times held a second, each time with a trial and a change back.
            let others = made[1 - better as usize];
            let times = Duration::from_secs(1).as_millis() / HELD.as_millis();
            assert!(others <= times as u32 * (WARM + TRIAL + WARM) && others > 0, "{took:?}: {made:?}");
        }
    }

    #[test]
    fn law_what_became_slower_is_given_up() {
        let clock = Cell::new(Instant::now());
        let mut choice = Choice::new(clock.get());
        exchanges(&mut choice, &clock, [1, 5], 1000);
        assert!(choice.way == Way::Apart);
        // Others have begun to compute. It is seen at the latest when it was held for its time.
        let held = HELD.as_micros() as u32 / 70 + BETWEEN + 2 * WARM + TRIAL;
        exchanges(&mut choice, &clock, [70, 5], held + BETWEEN);
        assert!(choice.way == Way::Together);
    }

    #[test]
    fn law_a_thread_runs_where_it_did_before() {
        let cpus = || {
            let mask = mask(0).expect("Linux");
            // SAFETY: plain data.
            (0..1024).filter(|cpu| unsafe { libc::CPU_ISSET(*cpu, &mask) }).collect::<Vec<_>>()
        };
        let (before, running) = (cpus(), RUNNING.load(Ordering::Relaxed));
        assert_eq!(next().processor, None, "no steps are made");
        let stepping = Stepping::begin();
        {
            let within = Stepping::begin();
            drop(within);
        }
        let mut bound = 0;
        for _ in 0..1000 {
            if let Some(processor) = next().processor {
                assert_eq!((cpus(), here()), (vec![processor], Some(processor)));
                bound += 1;
            }
            // The end comes in the midst of the trial, while it is bound.
            if bound == TRIAL {
                break;
            }
        }
        assert_eq!(bound, TRIAL);
        assert_eq!(RUNNING.load(Ordering::Relaxed), running + 1);
        drop(stepping);
        assert_eq!((cpus(), RUNNING.load(Ordering::Relaxed)), (before, running));
        assert_eq!(next().processor, None);
    }
}
