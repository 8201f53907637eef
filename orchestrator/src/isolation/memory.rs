//! Memory that two processes share, and whose turn it is in it. One side writes a request and hands over, the other one
//! answers and hands back; who waits looks for a while before it sleeps, since most answers come within microseconds.

use std::cell::Cell;
use std::fs::File;
use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd, RawFd};
use std::ptr;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

/// Who may write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum Side {
    /// The master.
    Client,
    /// The process of the unit.
    Server,
}

#[repr(C)]
struct Header {
    turn: AtomicU32,
    asleep: [AtomicU32; 2],
    /// Nobody looks: the other side needs this processor.
    at_once: AtomicU32,
    under_way: UnderWay,
    lengths: [AtomicU64; 3],
}

/// The call that the server makes, by the number of its function and one more; 0 while it makes none.
pub(super) struct UnderWay(AtomicU32);

impl UnderWay {
    pub(super) fn get(&self) -> Option<u32> {
        self.0.load(Ordering::Relaxed).checked_sub(1)
    }

    pub(super) fn set(&self, function: Option<u32>) {
        self.0.store(function.map_or(0, |number| number + 1), Ordering::Relaxed);
    }
}

/// The parts of the memory. Only what is touched takes any.
#[derive(Debug, Clone, Copy)]
pub(super) enum Part {
    /// What the unit logged since the client last looked.
    Log,
    /// From the client.
    Request,
    /// From the server.
    Answer,
}

const LOG: usize = 1 << 16;
/// A call with more bytes than this is not possible in another process.
pub(super) const BODY: usize = 1 << 30;
const PARTS: [(usize, usize); 3] = [(4096, LOG), (4096 + LOG, BODY), (4096 + LOG + BODY, BODY)];
const WHOLE: usize = 4096 + LOG + 2 * BODY;

/// How often the turn is looked at before going to sleep, at most: some 100 µs. Where both sides have a processor of their own an
/// answer comes within a microsecond, and sleeping would take twenty. Where they don't, looking keeps the other side from its work, so
/// each wait in vain looks less, down to none at all.
const MOST_LOOKS: u32 = 4000;
/// With fewer looks than this no answer comes: none are made.
const FEWEST_LOOKS: u32 = 100;
/// One wait in so many looks again, and as often as this: the processors may have become free.
const AGAIN: (u32, u32) = (100, 1000);

/// How often to look, from what came of looking before.
struct Looks {
    now: Cell<u32>,
    waits: Cell<u32>,
    most: u32,
}

impl Looks {
    fn new(most: u32) -> Self {
        Self { now: Cell::new(most), waits: Cell::new(0), most }
    }

    /// Looks; whether what was looked for came.
    fn look(&self, came: impl Fn() -> bool) -> bool {
        if self.now.get() == 0 {
            self.waits.set(self.waits.get() + 1);
            if !self.waits.get().is_multiple_of(AGAIN.0) {
                return came();
            }
            self.now.set(self.most.min(AGAIN.1));
        }
        for _ in 0..self.now.get() {
            if came() {
                self.now.set((2 * self.now.get()).min(self.most));
                return true;
            }
            std::hint::spin_loop();
        }
        let fewer = self.now.get() / 4;
        self.now.set(if fewer < FEWEST_LOOKS { 0 } else { fewer });
        false
    }
}

/// The memory, mapped.
pub(super) struct Shared {
    base: *mut u8,
    file: OwnedFd,
    looks: Looks,
}

// SAFETY: the mapping belongs to its owner and goes with it; each side writes only in its turn.
unsafe impl Send for Shared {}

impl Shared {
    /// New memory; the client's turn.
    pub(super) fn new() -> io::Result<Self> {
        // Of the kernel itself: the C library has a function of the name since GLIBC 2.27, our oldest is 2.17.
        // SAFETY: the name ends in zero; a new descriptor is nobody else's.
        let file = unsafe {
            let descriptor = libc::syscall(libc::SYS_memfd_create, c"unit".as_ptr(), libc::MFD_CLOEXEC);
            if descriptor < 0 {
                return Err(io::Error::last_os_error());
            }
            File::from(OwnedFd::from_raw_fd(descriptor as RawFd))
        };
        file.set_len(WHOLE as u64)?;
        Self::map(file.into())
    }

    /// Memory that the other process made.
    pub(super) fn map(file: OwnedFd) -> io::Result<Self> {
        // SAFETY: a new mapping of a file that has this length.
        let base = unsafe {
            let access = libc::PROT_READ | libc::PROT_WRITE;
            let flags = libc::MAP_SHARED | libc::MAP_NORESERVE;
            libc::mmap(ptr::null_mut(), WHOLE, access, flags, file.as_raw_fd(), 0)
        };
        if base == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        // On one processor the other side can't answer while this one looks.
        let alone = std::thread::available_parallelism().is_ok_and(|count| count.get() == 1);
        Ok(Self { base: base.cast(), file, looks: Looks::new(if alone { 0 } else { MOST_LOOKS }) })
    }

    /// The descriptor, for the other process.
    pub(super) fn descriptor(&self) -> i32 {
        self.file.as_raw_fd()
    }

    fn header(&self) -> &Header {
        // SAFETY: a page of zeros at first, which is a header; all its fields are atomic.
        unsafe { &*self.base.cast::<Header>() }
    }

    /// All of a part. Only to be used by the side whose turn it is.
    pub(super) fn part(&mut self, part: Part) -> &mut [u8] {
        let (at, length) = PARTS[part as usize];
        // SAFETY: within the mapping, which this value owns.
        unsafe { std::slice::from_raw_parts_mut(self.base.add(at), length) }
    }

    /// How much of a part is used; never more than it has.
    pub(super) fn length(&self, part: Part) -> usize {
        let said = self.header().lengths[part as usize].load(Ordering::Acquire);
        usize::try_from(said).map_or(0, |said| said.min(PARTS[part as usize].1))
    }

    pub(super) fn set_length(&self, part: Part, length: usize) {
        self.header().lengths[part as usize].store(length as u64, Ordering::Release);
    }

    /// Which call is under way: the server's word for it.
    pub(super) fn under_way(&self) -> &UnderWay {
        &self.header().under_way
    }

    /// Gives the turn to a side, and wakes it where it sleeps.
    pub(super) fn hand_to(&self, side: Side) {
        let header = self.header();
        header.turn.store(side as u32, Ordering::SeqCst);
        if header.asleep[side as usize].load(Ordering::SeqCst) != 0 {
            // SAFETY: the address is that of a word of the mapping.
            unsafe { libc::syscall(libc::SYS_futex, header.turn.as_ptr(), libc::FUTEX_WAKE, 1) };
        }
    }

    /// Whether who waits looks before it sleeps. Said by the client in its turn.
    pub(super) fn have_looks(&self, looks: bool) {
        self.header().at_once.store(u32::from(!looks), Ordering::Relaxed);
    }

    /// Waits for the turn of a side, no longer than a while; whether it came.
    pub(super) fn wait_for(&self, side: Side, at_most: Duration) -> bool {
        let header = self.header();
        let mine = || header.turn.load(Ordering::SeqCst) == side as u32;
        let at_once = header.at_once.load(Ordering::Relaxed) != 0;
        if if at_once { mine() } else { self.looks.look(mine) } {
            return true;
        }
        let asleep = &header.asleep[side as usize];
        asleep.store(1, Ordering::SeqCst);
        let other = 1 - side as u32;
        if !mine() {
            let limit = libc::timespec {
                tv_sec: at_most.as_secs().cast_signed(),
                tv_nsec: i64::from(at_most.subsec_nanos()),
            };
            // SAFETY: the address is that of a word of the mapping; sleeps only while the turn is the other's.
            unsafe {
                libc::syscall(
                    libc::SYS_futex,
                    header.turn.as_ptr(),
                    libc::FUTEX_WAIT,
                    other,
                    &raw const limit,
                );
            }
        }
        asleep.store(0, Ordering::SeqCst);
        mine()
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // SAFETY: mapped by this value, and used no more.
        unsafe { libc::munmap(self.base.cast(), WHOLE) };
    }
}

#[cfg(test)]
mod tests {
    use super::{AGAIN, FEWEST_LOOKS, Looks, MOST_LOOKS, Part, Shared, Side};
    use std::cell::Cell;
    use std::sync::{Mutex, PoisonError};
    use std::time::{Duration, Instant};

    /// One at a time: another mapping may come where one has gone.
    static ALONE: Mutex<()> = Mutex::new(());

    #[test]
    fn law_looking_in_vain_stops_and_begins_again() {
        let looks = Looks::new(MOST_LOOKS);
        let seen = Cell::new(0);
        let never = || {
            seen.set(seen.get() + 1);
            false
        };
        assert!(!looks.look(never) && seen.take() == MOST_LOOKS);
        // A quarter, a sixteenth, and then just once a wait, until it is tried again.
        let waits: Vec<u32> = (0..102).map(|_| (looks.look(never), seen.take()).1).collect();
        assert_eq!(waits[..3], [MOST_LOOKS / 4, MOST_LOOKS / 16, 1]);
        assert_eq!(waits[2..].iter().position(|looks| *looks > 1), Some(AGAIN.0 as usize - 1));
        assert!(looks.look(|| true) && looks.look(|| true) && looks.look(|| true));
        assert!(!looks.look(never) && seen.take() > MOST_LOOKS / 4, "it pays, so it looks more");
        let alone = Looks::new(0);
        assert!((0..1000).all(|_| !alone.look(never) && seen.take() <= 1), "one processor");
        let few = Looks::new(4 * FEWEST_LOOKS);
        let waits: Vec<u32> = (0..3).map(|_| (few.look(never), seen.take()).1).collect();
        assert_eq!(waits, [4 * FEWEST_LOOKS, FEWEST_LOOKS, 1], "so many are still worth it");
    }

    #[test]
    fn law_either_side_sleeps_until_its_turn_or_the_end_of_its_patience() {
        let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let shared = Shared::new().expect("memory");
        let patience = Duration::from_millis(30);
        for (turn, waits) in [(Side::Client, Side::Server), (Side::Server, Side::Client)] {
            shared.hand_to(turn);
            assert!(shared.wait_for(turn, patience), "{turn:?} has it");
            let began = Instant::now();
            assert!(!shared.wait_for(waits, patience), "{waits:?} has not");
            // It may look for a while before it sleeps, and the kernel sleeps no shorter than it is asked to.
            assert!(began.elapsed() >= patience, "{waits:?} slept {:?}", began.elapsed());
        }
    }

    #[test]
    fn law_a_part_is_never_longer_than_it_is_and_nobody_looks_who_is_told_so() {
        let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let shared = Shared::new().expect("memory");
        shared.set_length(Part::Log, 7);
        assert_eq!((shared.length(Part::Log), shared.length(Part::Request)), (7, 0));
        shared.set_length(Part::Log, usize::MAX);
        assert_eq!(shared.length(Part::Log), super::LOG);
        let looked = |looks: bool| {
            shared.have_looks(looks);
            shared.looks.now.set(MOST_LOOKS);
            assert!(!shared.wait_for(Side::Server, Duration::ZERO));
            shared.looks.now.get() < MOST_LOOKS
        };
        assert!(looked(true) && !looked(false) && looked(true));
        let mapped = || {
            let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux has it");
            maps.lines().any(|line| line.contains("/memfd:unit"))
        };
        assert!(mapped());
        drop(shared);
        assert!(!mapped(), "it goes with its owner");
    }
}
