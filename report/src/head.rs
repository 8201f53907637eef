//! What a page says first: what came of it, and where it comes from. Pages of runs, diagnoses and reproductions share
//! both, and `summary.json` holds them for programs.

use crate::Page;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};

/// How it went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Standing {
    /// As wished.
    Good,
    /// Not as wished.
    Bad,
    /// Nobody said what is wished.
    Plain,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// How it went.
    pub standing: Standing,
    /// The same in a sentence, e.g. `lost balance at t = 1.89 s`.
    pub words: String,
    /// Numbers beside it.
    pub figures: Vec<Figure>,
    /// What a person should know beside it: warnings, values that are no numbers.
    pub notes: Vec<String>,
}

/// A number of a verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// What it is, e.g. `peak torque`.
    pub label: String,
    /// Its value; `None` if there is none.
    pub value: Option<f64>,
    /// Physical unit; empty: none.
    pub unit: String,
    /// How the value is written; with four significant digits, if nothing says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub written: Option<String>,
}

/// Where it comes from: enough to make it again and to tell whether the same came out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Provenance {
    /// What made it.
    pub program: Program,
    /// Files that were read, the scenario or data set first.
    pub inputs: Vec<Input>,
    /// Values that differ from what the inputs say.
    pub changes: Vec<Change>,
    /// The units.
    pub units: Vec<Origin>,
    /// What else tells this result from another: runs and rows used, say.
    pub facts: Vec<(String, String)>,
    /// The command that makes it again.
    pub command: String,
}

/// A program.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// The commit that it was built from; `unknown` outside a repository.
    pub commit: String,
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// What it is to the result: `scenario`, `signal`, `data set`.
    pub role: String,
    /// Its name as it was given.
    pub name: String,
    /// Checksum of its bytes in hexadecimal digits.
    pub sha256: String,
}

/// A value that was given beside the inputs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// `unit.variable`, or `stop`.
    pub name: String,
    /// The value as it was typed.
    pub value: String,
}

/// A unit and what it was made by.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Name in the scenario.
    pub name: String,
    /// Name of its file.
    pub file: String,
    /// `guid` of its description.
    pub guid: String,
    /// `generationTool` of its description; empty: not said.
    pub tool: String,
    /// Checksum of the file in hexadecimal digits.
    pub sha256: String,
}

/// So many digits of a checksum tell two files of a person apart.
const SHOWN: usize = 12;

impl Program {
    /// In a line: `acroscope 0.1.0, commit 2e2cedc`.
    pub fn line(&self) -> String {
        format!("{} {}, commit {}", self.name, self.version, self.commit)
    }
}

impl Figure {
    /// A value with its unit, written with four significant digits.
    pub fn new(label: impl Into<String>, value: Option<f64>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), value, unit: unit.into(), written: None }
    }

    /// In words: `peak torque 1.23 N·m`.
    pub fn line(&self) -> String {
        format!("{} {}", self.label, self.text())
    }

    /// The value with its unit.
    pub fn text(&self) -> String {
        let gap = if self.unit.is_empty() { "" } else { " " };
        let written = |value| self.written.clone().unwrap_or_else(|| short(value));
        self.value.map_or_else(|| "none".to_owned(), |value| format!("{}{gap}{}", written(value), self.unit))
    }
}

impl Provenance {
    /// Labels and values, in the order in which a person reads them.
    pub fn rows(&self) -> Vec<(String, String)> {
        let digits = |sum: &str| format!("sha256 {}…", sum.get(..SHOWN).unwrap_or(sum));
        let mut rows: Vec<(String, String)> = (self.inputs.iter())
            .map(|input| (input.role.clone(), format!("{}, {}", input.name, digits(&input.sha256))))
            .collect();
        let changes: Vec<String> =
            self.changes.iter().map(|change| format!("{} = {}", change.name, change.value)).collect();
        rows.push((
            "changed".to_owned(),
            if changes.is_empty() { "nothing".into() } else { changes.join(", ") },
        ));
        rows.extend(self.facts.iter().cloned());
        rows.push(("made by".to_owned(), self.program.line()));
        rows.extend(self.units.iter().map(|unit| {
            let tool = if unit.tool.is_empty() { String::new() } else { format!(", made by {}", unit.tool) };
            let text = format!("{}, {}, GUID {}{tool}", unit.file, digits(&unit.sha256), unit.guid);
            (format!("unit {}", unit.name), text)
        }));
        rows
    }
}

/// Text with its ends of lines: an error tells the last calls of a unit below it.
fn lines(text: &str) -> Markup {
    html! { @for (number, line) in text.lines().enumerate() { @if number > 0 { br; } (line) } }
}

impl Page {
    /// The verdict, in large letters.
    pub fn verdict(&mut self, verdict: &Verdict) -> &mut Self {
        let class = match verdict.standing {
            Standing::Good => "verdict good",
            Standing::Bad => "verdict bad",
            Standing::Plain => "verdict",
        };
        self.push(html! {
            section class=(class) {
                p.words { (verdict.words) }
                @if !verdict.figures.is_empty() {
                    dl { @for figure in &verdict.figures { div { dt { (figure.label) } dd { (figure.text()) } } } }
                }
                @for note in &verdict.notes { p.note { (lines(note)) } }
            }
        })
    }

    /// What something is, line by line: labels and values.
    pub fn facts(&mut self, rows: &[(impl AsRef<str>, String)]) -> &mut Self {
        self.push(facts(rows))
    }

    /// Where it comes from in a line, for the head of a page whose foot has all of it.
    pub fn origin_line(&mut self, provenance: &Provenance) -> &mut Self {
        let inputs: Vec<&str> = provenance.inputs.iter().map(|input| input.name.as_str()).collect();
        self.push(html! { p.origin {
            "Made by " (provenance.program.line()) " with " code { (provenance.command) }
            @if !inputs.is_empty() { " from " (inputs.join(", ")) }
            "; checksums at the foot of the page."
        } })
    }

    /// Where it comes from, and how to make it again.
    pub fn provenance(&mut self, provenance: &Provenance) -> &mut Self {
        let rows = provenance.rows();
        self.push(html! {
            details.provenance open {
                summary { "Where this comes from" }
                (facts(&rows))
                p { "The command that makes it again:" }
                pre { (provenance.command) }
            }
        })
    }
}

fn facts(rows: &[(impl AsRef<str>, String)]) -> Markup {
    html! { div.scroll tabindex="0" { table.facts { tbody { @for (label, text) in rows {
        tr { th scope="row" { (label.as_ref()) } td { (text) } }
    } } } } }
}

/// Four significant digits, without zeros at the end: what a person compares.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A word of a command line as a shell takes it back.
pub fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::{Figure, Program, Provenance, Standing, Verdict, shell_word, short};
    use crate::Page;

    #[test]
    fn value_numbers_as_a_person_compares_them() {
        let cases = [
            (0.0, "0"),
            (1.8916, "1.892"),
            (120.0, "120"),
            (0.036_123, "0.03612"),
            (3.0, "3"),
            (12_345.6, "12346"),
            (1e-7, "1.000e-7"),
            (-2.5, "-2.5"),
        ];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn value_figures_and_programs_in_a_line() {
        let figure = |value, unit: &str| Figure::new("peak", value, unit);
        assert_eq!(figure(Some(1.25), "N·m").line(), "peak 1.25 N·m");
        assert_eq!(figure(Some(3.0), "").line(), "peak 3");
        assert_eq!(figure(None, "N·m").line(), "peak none");
        let close = Figure { written: Some("1.00054".into()), ..figure(Some(1.000_54), "") };
        assert_eq!(close.line(), "peak 1.00054");
        let program = Program { name: "p".into(), version: "1".into(), commit: "abc".into() };
        assert_eq!(program.line(), "p 1, commit abc");
    }

    #[test]
    fn law_a_word_comes_back_from_the_shell() {
        for word in ["camera.k1=0.1", "a b", "it's", "$HOME", "", "*", "ä"] {
            let output = std::process::Command::new("sh")
                .args(["-c", &format!("printf %s {}", shell_word(word))])
                .output()
                .expect("there is a shell");
            assert_eq!(String::from_utf8_lossy(&output.stdout), word);
        }
        for plain in ["camera.k1=0.1", "a/b_c-d.toml", "x:y,z@1%", "A+"] {
            assert_eq!(shell_word(plain), plain, "what needs no quotes has none");
        }
    }

    #[test]
    fn law_the_verdict_stands_before_where_it_comes_from() {
        let verdict = Verdict {
            standing: Standing::Bad,
            words: "fell at t < 2 s".into(),
            figures: vec![Figure::new("peak", Some(1.5), "N·m")],
            notes: Vec::new(),
        };
        let program = Program { name: "p".into(), version: "1".into(), commit: "abc".into() };
        let provenance = Provenance { program, command: "p run x".into(), ..Provenance::default() };
        let mut page = Page::new("x");
        page.verdict(&verdict).provenance(&provenance);
        let html = page.to_html();
        let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} is on the page"));
        assert!(at("fell at t &lt; 2 s") < at("1.5 N·m") && at("1.5 N·m") < at("p 1, commit abc"));
        assert!(at("p run x") > 0 && html.contains("verdict bad"));
    }
}
