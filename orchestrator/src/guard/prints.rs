//! What units print to the standard output is not what the program has to say there.

use std::fs::File;
use std::os::fd::AsFd as _;

/// From now on what units and their libraries print goes to the standard error; the standard output, which only the program itself has from
/// then on. `None` where there is not the one or the other: then nothing is changed.
pub fn own_output() -> Option<File> {
    let own = std::io::stdout().as_fd().try_clone_to_owned().ok()?;
    // SAFETY: numbers of descriptors; what the call answers is looked at.
    (unsafe { libc::dup2(2, 1) } == 1).then(|| File::from(own))
}
