//! Rules that read: the archive and the description. A rule is a function and a row here.

mod aliases;
mod archive;
mod causality;
mod experiment;
mod names;
mod schema;
mod structure;
mod units;
mod values;

use crate::archive::Archive;
use crate::finding::{Finding, Found};
use crate::looked::LeftOut;
use crate::model::{Model, Variable};
use crate::xml::{Element, Fault};

/// A rule on the file: archive, and the description as text.
struct OnFile {
    id: &'static str,
    find: fn(&File<'_>, &mut Found),
    /// What it has to have for there to be anything to look at.
    needs: Needs,
}

/// How far the description must be read for a rule on the file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Needs {
    Nothing,
    /// That the description, if there is one, is of our version.
    Ours,
    Text,
    Tree,
}

/// A rule on what the description says.
struct OnModel {
    id: &'static str,
    find: fn(&Model<'_>, &mut Found),
}

/// The file, with its description read as far as that goes.
pub(crate) struct File<'a> {
    pub(crate) archive: &'a Archive,
    pub(crate) tree: Option<&'a Result<Element, Fault>>,
}

impl File<'_> {
    fn root(&self) -> Option<&Element> {
        self.tree.and_then(|tree| tree.as_ref().ok())
    }

    /// Why there is nothing to look at for a rule, if there is nothing.
    fn lacks(&self, needs: Needs) -> Option<&'static str> {
        match (needs, self.tree) {
            (Needs::Nothing, _) => None,
            (Needs::Ours, _) => self.root().filter(|root| !schema::is_ours(root)).map(|_| FOREIGN),
            (_, None) => Some("there is no description to read"),
            (Needs::Tree, Some(Err(_))) => Some("the description can't be read to its end"),
            _ => None,
        }
    }
}

/// The rule that tells a description of another version.
const SCHEMA: &str = "schema";
/// Why rules of FMI 2.0 are not looked at.
const FOREIGN: &str = "it is no description of FMI 2.0";

const ON_FILE: &[OnFile] = &[
    OnFile { id: "archive-layout", find: archive::layout, needs: Needs::Nothing },
    OnFile { id: "archive-paths", find: archive::paths, needs: Needs::Nothing },
    OnFile { id: "binaries", find: archive::binaries, needs: Needs::Nothing },
    OnFile { id: "binary-functions", find: archive::functions, needs: Needs::Ours },
    OnFile { id: "source-files", find: archive::sources, needs: Needs::Tree },
    OnFile { id: "well-formed", find: schema::well_formed, needs: Needs::Text },
    OnFile { id: SCHEMA, find: schema::schema, needs: Needs::Tree },
];

const ON_MODEL: &[OnModel] = &[
    OnModel { id: "identity", find: experiment::identity },
    OnModel { id: "capabilities", find: experiment::capabilities },
    OnModel { id: "default-experiment", find: experiment::default_experiment },
    OnModel { id: "variable-names", find: names::variables },
    OnModel { id: "structured-names", find: names::structured },
    OnModel { id: "unique-names", find: names::definitions },
    OnModel { id: "units", find: units::units },
    OnModel { id: "unit-definitions", find: units::definitions },
    OnModel { id: "types", find: units::types },
    OnModel { id: "min-max", find: values::min_max },
    OnModel { id: "start-range", find: values::start_range },
    OnModel { id: "start-missing", find: values::start_missing },
    OnModel { id: "start-superfluous", find: values::start_superfluous },
    OnModel { id: "nominal", find: values::nominal },
    OnModel { id: "causality-variability", find: causality::variability },
    OnModel { id: "initial", find: causality::initial },
    OnModel { id: "independent", find: causality::independent },
    OnModel { id: "derivative", find: causality::derivative },
    OnModel { id: "aliases", find: aliases::aliases },
    OnModel { id: "structure-index", find: structure::index },
    OnModel { id: "outputs", find: structure::outputs },
    OnModel { id: "derivatives", find: structure::derivatives },
    OnModel { id: "initial-unknowns", find: structure::initial_unknowns },
    OnModel { id: "dependencies-list", find: structure::dependencies },
];

/// Names of these rules, in the order in which they are looked at.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ON_FILE.iter().map(|rule| rule.id).chain(ON_MODEL.iter().map(|rule| rule.id))
}

/// What all of them find, and those that had nothing to look at.
pub(crate) fn findings(archive: &Archive) -> (Vec<Finding>, Vec<LeftOut>) {
    let read = archive.description.as_ref().ok();
    let tree = read.map(|text| text.as_ref().map_err(Clone::clone).and_then(|text| Element::parse(text)));
    let file = File { archive, tree: tree.as_ref() };
    let (mut all, mut left_out) = (Vec::new(), Vec::new());
    for rule in ON_FILE {
        if let Some(why) = file.lacks(rule.needs) {
            left_out.push(LeftOut { rule: rule.id, why: why.into() });
            continue;
        }
        let mut found = Found::new(rule.id);
        (rule.find)(&file, &mut found);
        all.append(&mut found.findings);
    }
    // A description of another version or kind is told by `schema`; its variables have other rules.
    let Some(root) = file.root().filter(|root| schema::is_ours(root)) else {
        // That it is another standard's comes first: all else may follow from it.
        all.sort_by_key(|finding| file.root().is_some() && finding.rule != SCHEMA);
        let why = file.lacks(Needs::Tree).unwrap_or(FOREIGN);
        left_out.extend(ON_MODEL.iter().map(|rule| LeftOut { rule: rule.id, why: why.into() }));
        return (all, left_out);
    };
    let model = Model::of(root);
    for rule in ON_MODEL {
        let mut found = Found::new(rule.id);
        (rule.find)(&model, &mut found);
        all.append(&mut found.findings);
    }
    (all, left_out)
}

/// Findings about a variable say its line and its name.
impl Found {
    fn error_of(&mut self, variable: &Variable<'_>, text: impl std::fmt::Display) {
        let text = crate::finding::at(variable.line, text);
        self.say(crate::Severity::Error, Some(variable.name), text);
    }

    fn warning_of(&mut self, variable: &Variable<'_>, text: impl std::fmt::Display) {
        let text = crate::finding::at(variable.line, text);
        self.say(crate::Severity::Warning, Some(variable.name), text);
    }
}
