//! Log categories: those that a unit declares can be asked for, those that it uses are declared (FMI 2.0.4 sections 2.1.5
//! and 2.2.4).

use super::bench::{Bench, Halt};
use crate::finding::Found;
use orchestrator::Kind;
use orchestrator::fmu::LogLine;
use std::collections::BTreeSet;

pub(super) fn categories(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let declared = &bench.description().log_categories;
    let mut unit = bench.instance("unit")?;
    if !declared.is_empty()
        && let Err(Halt::Call(error)) =
            unit.call("fmi2SetDebugLogging with all categories", |i| i.set_debug_logging(true, declared))
    {
        found.error(format!("its own log categories are refused: {error}"));
    }
    unit.set_up()?;
    unit.exit_initialization()?;
    for k in 0..3 {
        unit.advance(k)?;
    }
    // Something to complain about. What comes of it is another rule's matter.
    let _ =
        unit.call("fmi2GetReal of the unknown value reference 4294967295", |i| i.get(Kind::Real, u32::MAX));
    let lines = unit.call("the log", |instance| Ok(instance.log()))?;
    let known = |line: &&LogLine| line.category.is_empty() || declared.contains(&line.category);
    let strange: BTreeSet<&str> =
        lines.iter().filter(|line| !known(line)).map(|line| line.category.as_str()).collect();
    if !strange.is_empty() && !declared.is_empty() {
        let strange: Vec<&str> = strange.into_iter().collect();
        found.warning(format!(
            "it logs in categories that LogCategories does not declare: {}",
            strange.join(", ")
        ));
    }
    Ok(())
}
