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

/// Does the pieces 0, 1, ... with so many threads, each with a worker of its own, and takes their results in order. The first
/// error ends it.
pub(crate) fn in_order<W, T: Send>(
    threads: usize,
    pieces: usize,
    worker: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, usize) -> Result<T, Error> + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), Error>,
) -> Result<(), Error> {
    let state = Mutex::new(State { next: 0, taken: 0, stopped: false, done: BTreeMap::new() });
    let (changed, threads) = (Condvar::new(), threads.clamp(1, pieces.max(1)));
    let lock = || state.lock().unwrap_or_else(PoisonError::into_inner);
    let wait = |held| changed.wait(held).unwrap_or_else(PoisonError::into_inner);
    let claim = || {
        let mut held: MutexGuard<'_, State<T>> = lock();
        while !held.stopped && held.next < pieces && held.next >= held.taken + AHEAD * threads {
            held = wait(held);
        }
        let piece = held.next;
        (!held.stopped && piece < pieces).then(|| {
            held.next += 1;
            piece
        })
    };
    let go = || {
        let mut worker = worker();
        while let Some(piece) = claim() {
            let result = work(&mut worker, piece);
            lock().done.insert(piece, result);
            changed.notify_all();
        }
    };
    let mut hand_over = || {
        for piece in 0..pieces {
            let mut held = lock();
            let result = loop {
                match held.done.remove(&piece) {
                    Some(result) => break result,
                    // A thread panicked; the scope tells.
                    None if held.stopped => return Ok(()),
                    None => held = wait(held),
                }
            };
            drop(held);
            take(piece, result?)?;
            lock().taken = piece + 1;
            changed.notify_all();
        }
        Ok(())
    };
    // A thread that panics must not leave the others waiting.
    let stop = || {
        lock().stopped = true;
        changed.notify_all();
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| Guarded(&stop).around(&go));
        }
        let handed = hand_over();
        stop();
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
