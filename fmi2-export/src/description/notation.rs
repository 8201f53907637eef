//! The notation table of a unit in Markdown: its section of NOTATION.md.

use super::{GROUPS, Unit, number};
use crate::table::{Kind, Variable};
use std::fmt::Write;

impl Unit {
    /// A section with one table for each causality.
    pub fn notation(&self) -> String {
        let mut text = format!("## {}\n\n{}\n", self.head.identifier, self.head.description);
        for (causality, title) in GROUPS {
            let mut members =
                self.variables.iter().filter(|variable| variable.causality == causality).peekable();
            if members.peek().is_none() {
                continue;
            }
            text.push_str(&format!(
                "\n### {title}\n\n| name | symbol | unit | start | meaning |\n|---|---|---|---|---|\n"
            ));
            for variable in members {
                let cells = [
                    format!("`{}`", variable.name),
                    cell(variable.symbol),
                    cell(variable.unit_name()),
                    cell(&variable.start_or_off()),
                    cell(variable.description),
                ];
                let _ = writeln!(text, "| {} |", cells.join(" | ")); // writing to a String can't fail
            }
        }
        text
    }
}

impl Variable {
    /// The unit, for people: nothing for a variable that has none.
    pub(super) fn unit_name(&self) -> &'static str {
        if matches!(self.kind, Kind::Real(_)) { self.unit.name } else { "" }
    }

    /// The start value, marked if the effect is off there; nothing for what the unit computes.
    pub(super) fn start_or_off(&self) -> String {
        use crate::table::Causality::{Input, Parameter};
        match (self.causality, &self.kind) {
            (Input | Parameter, Kind::Real(value)) if self.is_effect => format!("{} (off)", number(*value)),
            (Input | Parameter, _) if self.is_effect => format!("{} (off)", self.start()),
            (Input | Parameter, _) => self.start(),
            _ => String::new(),
        }
    }
}

/// A bar would end the cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
