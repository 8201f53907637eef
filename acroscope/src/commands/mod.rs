//! One file a command.

mod check;
mod completions;
mod container;
mod diagnose;
mod import;
mod man;
mod new;
mod params;
mod record;
mod reproduce;
mod ssp;
mod sweep;
mod view;

use crate::cli::{Arguments, Command};
use crate::error::Error;
use crate::formats;

/// Does what was typed.
pub fn dispatch(arguments: &Arguments) -> Result<(), Error> {
    match &arguments.command {
        Command::Check(check) => check::check(check, arguments.quiet),
        Command::Completions(completions) => completions::completions(completions),
        Command::Container(packing) => container::container(packing, arguments.quiet),
        Command::Diagnose(diagnose) => diagnose::diagnose(diagnose, arguments.quiet),
        Command::Import(import) => import::import(import, arguments.quiet),
        Command::Man(man) => man::man(man, arguments.quiet),
        Command::New(new) => new::new(new, arguments.quiet),
        Command::Params(params) => params::params(params),
        Command::Record(record) => record::record(record, arguments.quiet),
        Command::Reproduce(reproduce) => reproduce::reproduce(reproduce, arguments.quiet),
        Command::View(view) => view::view(view, arguments.quiet),
        Command::Run(run) => Ok(runner::run(run, arguments.quiet, &formats::write)?),
        Command::Ssp(packing) => ssp::ssp(packing, arguments.quiet),
        Command::Sweep(sweep) => sweep::sweep(sweep, arguments.quiet),
    }
}
