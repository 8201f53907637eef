//! How the processor rounds reals, and whether it flushes small ones to zero: a unit that changes it would change what all others
//! and the master compute. Libraries that were built with `-ffast-math` do so when they are loaded.

/// Does something, and puts the control word back afterwards.
pub(crate) fn kept<T>(work: impl FnOnce() -> T) -> T {
    let before = read();
    let answer = work();
    put_back(before);
    answer
}

/// Puts the control word back if it is another one; whether it was.
#[inline(always)]
pub(crate) fn put_back(before: u32) -> bool {
    let changed = read() != before;
    if changed {
        write(before);
    }
    changed
}

/// The control word, without the flags that calculations leave behind.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn read() -> u32 {
    const FLAGS: u32 = 0x3f;
    let mut word = 0u32;
    // SAFETY: stores the register into a value that is ours.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &mut word, options(nostack, preserves_flags)) };
    word & !FLAGS
}

#[cfg(target_arch = "x86_64")]
#[cold]
fn write(word: u32) {
    // SAFETY: a word that the register had.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &word, options(nostack, preserves_flags, readonly)) };
}

/// The control word.
#[cfg(target_arch = "aarch64")]
#[inline(always)]
pub(crate) fn read() -> u32 {
    let word: u64;
    // SAFETY: reads a register.
    unsafe { std::arch::asm!("mrs {}, fpcr", out(reg) word, options(nomem, nostack, preserves_flags)) };
    word as u32
}

#[cfg(target_arch = "aarch64")]
#[cold]
fn write(word: u32) {
    // SAFETY: a word that the register had.
    unsafe {
        std::arch::asm!("msr fpcr, {}", in(reg) u64::from(word), options(nomem, nostack, preserves_flags))
    };
}

/// Elsewhere it is not looked at.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[inline(always)]
pub(crate) fn read() -> u32 {
    0
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn write(_: u32) {}
