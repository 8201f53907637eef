//! One file a command.

mod diagnose;
mod record;
mod reproduce;
mod run;

use crate::cli::{Arguments, Command};
use crate::error::Error;

/// Does what was typed.
pub fn dispatch(arguments: &Arguments) -> Result<(), Error> {
    match &arguments.command {
        Command::Diagnose(diagnose) => diagnose::diagnose(diagnose, arguments.quiet),
        Command::Record(record) => record::record(record, arguments.quiet),
        Command::Reproduce(reproduce) => reproduce::reproduce(reproduce, arguments.quiet),
        Command::Run(run) => run::run(run, arguments.quiet),
    }
}
