//! One file a command.

mod run;

use crate::cli::{Arguments, Command};
use crate::error::Error;

/// Does what was typed.
pub fn dispatch(arguments: &Arguments) -> Result<(), Error> {
    match &arguments.command {
        Command::Run(run) => run::run(run, arguments.quiet),
    }
}
