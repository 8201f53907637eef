//! The HTML page of a unit: `documentation/index.html` in the `.fmu`.

use super::{GROUPS, Unit, escape};
use std::fmt::Write;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}\
    table{border-collapse:collapse;width:100%}th,td{text-align:left;vertical-align:top;padding:.3em .6em;\
    border-bottom:1px solid #ddd}th{border-bottom:2px solid #888}code{font-size:.95em}.off{color:#777}";

impl Unit {
    /// A page that stands alone.
    pub fn html(&self) -> String {
        let head = &self.head;
        let title = escape(head.identifier);
        let mut page = format!(
            "<!DOCTYPE html><!-- Generated from the unit's declaration. Do not edit. -->\n<html lang=\"en\">\n\
             <head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
             <h1>{title}</h1>\n<p>{}</p>\n<p>Version {}. FMI 2.0 for co-simulation: any communication step size, \
             saved and serialised states, derivatives of inputs of first order{}. GUID <code>{}</code>.</p>\n",
            escape(head.description),
            escape(head.version),
            if head.provides_derivatives { ", directional derivatives" } else { "" },
            self.guid(),
        );
        for (causality, title) in GROUPS {
            let mut members =
                self.variables.iter().filter(|variable| variable.causality == causality).peekable();
            if members.peek().is_none() {
                continue;
            }
            page.push_str(&format!(
                "<h2>{title}</h2>\n<table>\n<tr><th>name<th>symbol<th>unit<th>start<th>range<th>changes<th>meaning\n"
            ));
            for variable in members {
                let _ = writeln!(
                    page,
                    "<tr><td><code>{}</code><td>{}<td>{}<td>{}<td>{}<td>{}<td>{}",
                    escape(variable.name),
                    escape(variable.symbol),
                    escape(variable.unit_name()),
                    escape(&variable.start_or_off()),
                    escape(&variable.range()),
                    format!("{:?}", variable.variability).to_lowercase(),
                    escape(variable.description),
                ); // writing to a String can't fail
            }
            page.push_str("</table>\n");
        }
        page.push_str("</body>\n</html>\n");
        page
    }
}
