//! Threads that work ahead, and their results in order: what is handed over first is what was asked for first, however long
//! it took. They stay within a window before what was handed over, so that memory doesn't grow with the work.

use crate::error::Error;
use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Pieces of work that may be under way or wait, for each thread.
const AHEAD: usize = 8;

struct State<T> {
    next: usize,
    taken: usize,
    stopped: bool,
    done: BTreeMap<usize, Result<T, Error>>,
}

/// What the threads share.
struct Pool<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
    pieces: usize,
    /// How far a piece may be from what was handed over.
    window: usize,
}

impl<T> Pool<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, held: MutexGuard<'a, State<T>>) -> MutexGuard<'a, State<T>> {
        self.changed.wait(held).unwrap_or_else(PoisonError::into_inner)
    }

    /// The next piece to be done, as soon as it is within the window.
    fn claim(&self) -> Option<usize> {
        let mut held = self.lock();
        while !held.stopped && held.next < self.pieces && held.next >= held.taken + self.window {
            held = self.wait(held);
        }
        let piece = held.next;
        (!held.stopped && piece < self.pieces).then(|| {
            held.next += 1;
            piece
        })
    }

    fn done(&self, piece: usize, result: Result<T, Error>) {
        self.lock().done.insert(piece, result);
        self.changed.notify_all();
    }

    /// What came of a piece, as soon as it is there. `None`: a thread panicked; the scope tells.
    fn result(&self, piece: usize) -> Option<Result<T, Error>> {
        let mut held = self.lock();
        loop {
            match held.done.remove(&piece) {
                Some(result) => return Some(result),
                None if held.stopped => return None,
                None => held = self.wait(held),
            }
        }
    }

    /// Takes all results in order.
    fn hand_over(&self, mut take: impl FnMut(usize, T) -> Result<(), Error>) -> Result<(), Error> {
        for piece in 0..self.pieces {
            let Some(result) = self.result(piece) else { return Ok(()) };
            take(piece, result?)?;
            self.lock().taken = piece + 1;
            self.changed.notify_all();
        }
        Ok(())
    }

    fn stop(&self) {
        self.lock().stopped = true;
        self.changed.notify_all();
    }
}

/// Does the pieces 0, 1, ... with so many threads, each with a worker of its own, and takes their results in order. The first
/// error ends it.
pub(crate) fn in_order<W, T: Send>(
    threads: usize,
    pieces: usize,
    worker: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, usize) -> Result<T, Error> + Sync,
    take: impl FnMut(usize, T) -> Result<(), Error>,
) -> Result<(), Error> {
    let state = Mutex::new(State { next: 0, taken: 0, stopped: false, done: BTreeMap::new() });
    let threads = threads.clamp(1, pieces.max(1));
    let pool = Pool { state, changed: Condvar::new(), pieces, window: AHEAD * threads };
    let go = || {
        let mut worker = worker();
        while let Some(piece) = pool.claim() {
            pool.done(piece, work(&mut worker, piece));
        }
    };
    // A thread that panics must not leave the others waiting.
    let stop = || pool.stop();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| Guarded(&stop).around(&go));
        }
        let handed = pool.hand_over(take);
        pool.stop();
        handed
    })
}

/// Calls the alarm if what it goes around panics.
struct Guarded<'a, F: Fn()>(&'a F);

impl<F: Fn()> Guarded<'_, F> {
    fn around(self, work: &dyn Fn()) {
        work();
        std::mem::forget(self);
    }
}

impl<F: Fn()> Drop for Guarded<'_, F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

#[cfg(test)]
mod tests {
    use super::in_order;
    use crate::Error;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn law_results_come_in_order_and_none_is_far_ahead() {
        let (handed, furthest) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let mut seen = Vec::new();
        let work = |_: &mut (), piece: usize| {
            furthest.fetch_max(piece - handed.load(Ordering::SeqCst).min(piece), Ordering::SeqCst);
            if piece.is_multiple_of(7) {
                std::thread::sleep(std::time::Duration::from_millis(2));
            }
            Ok(piece * piece)
        };
        let take = |piece: usize, square: usize| {
            seen.push(square);
            handed.store(piece + 1, Ordering::SeqCst);
            Ok(())
        };
        in_order(3, 200, || (), work, take).expect("no error");
        assert!(seen.iter().copied().eq((0..200).map(|piece| piece * piece)));
        assert!(furthest.load(Ordering::SeqCst) <= 8 * 3 + 1);
    }

    #[test]
    fn law_the_first_error_ends_it() {
        let wrong = |piece: usize| Error::Partition { part: piece as u64, of: 1 };
        let work = |_: &mut (), piece: usize| if piece >= 5 { Err(wrong(piece)) } else { Ok(()) };
        let mut taken = 0;
        let ended = in_order(
            2,
            1000,
            || (),
            work,
            |_, ()| {
                taken += 1;
                Ok(())
            },
        );
        assert!(matches!(ended, Err(Error::Partition { part: 5, .. })) && taken == 5);
    }
}
