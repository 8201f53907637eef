//! An instance that was freed leaves nothing behind (FMI 2.0.4 section 2.1.5).

#![allow(unsafe_code)] // asks the C library for the heap's size

use super::bench::{Bench, Halt};
use crate::Severity;
use crate::finding::Found;
use std::time::{Duration, Instant};

/// So many instances, one after the other, if there is time for them.
const INSTANCES: usize = 1000;
/// Before these the memory of the process is still finding its size.
const WARM: usize = 100;
const TIME: Duration = Duration::from_secs(20);
/// What each instance must leave to be called a leak: on the heap, which is counted to the byte, and of the whole process,
/// which is counted in pages and has its ups and downs.
const OF_HEAP: f64 = 16.0;
const OF_PROCESS: f64 = 2048.0;

pub(super) fn leak(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let begin = Instant::now();
    let mut course = Vec::with_capacity(INSTANCES);
    for _ in 0..INSTANCES {
        let mut unit = bench.started("unit")?;
        unit.advance(0)?;
        drop(unit);
        course.push(memory());
        if begin.elapsed() > TIME {
            break;
        }
    }
    let warm = WARM.min(course.len() / 4);
    let half = (course.len() + warm) / 2;
    if course.len() < 2 * warm.max(10) {
        found.note(format!("only {} instances in {} s: too few to see a leak", course.len(), TIME.as_secs()));
        return Ok(());
    }
    let last = course.len() - 1;
    // It must grow in the first half and in the second: what a library allots once is no leak.
    let growth = |of: fn(&Memory) -> u64| {
        let per =
            |from: usize, to: usize| (of(&course[to]) as f64 - of(&course[from]) as f64) / (to - from) as f64;
        per(warm, half).min(per(half, last))
    };
    let (heap, process) = (growth(|memory| memory.heap), growth(|memory| memory.process));
    if heap >= OF_HEAP || process >= OF_PROCESS {
        let bytes = heap.max(process).round();
        // A tool that the unit brings into the process, an interpreter say, may keep what it likes.
        let of_tool = bench.description().co_simulation.needs_execution_tool;
        let severity = if of_tool { Severity::Warning } else { Severity::Error };
        found.say(severity, None, format!(
            "each instance leaves some {bytes} bytes behind after fmi2FreeInstance ({} instances were made)",
            course.len()
        ));
    }
    Ok(())
}

struct Memory {
    /// Bytes of the heap that are in use.
    heap: u64,
    /// Bytes of the process that are in memory.
    process: u64,
}

fn memory() -> Memory {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let resident = pages.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok()).unwrap_or(0);
    Memory { heap: heap(), process: resident * 4096 }
}

/// Bytes of the heap in use. `mallinfo2` is of GLIBC 2.33, the oldest that we run with is 2.17; there the older function counts, to 4 GiB.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn heap() -> u64 {
    // SAFETY: a name that ends in zero; what the C library has by it takes nothing and answers plain numbers, as the older function does.
    unsafe {
        let found = libc::dlsym(libc::RTLD_DEFAULT, c"mallinfo2".as_ptr());
        if found.is_null() {
            let all = libc::mallinfo();
            return u64::from(all.uordblks as u32) + u64::from(all.hblkhd as u32);
        }
        let all = std::mem::transmute::<*mut libc::c_void, extern "C" fn() -> libc::mallinfo2>(found)();
        (all.uordblks + all.hblkhd) as u64
    }
}

/// Elsewhere nobody counts it.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn heap() -> u64 {
    0
}
