//! Random calls, to come.
use crate::Result;
#[derive(clap::Args)]
pub struct Options {}
pub fn fuzz(_: &Options) -> Result<()> {
    Ok(())
}
