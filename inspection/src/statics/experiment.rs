//! What a unit says of itself as a whole: who it is, what it can, for how long it is meant to run (FMI 2.0.4 sections
//! 2.2.1, 2.2.5 and 4.3.1).

use crate::finding::Found;
use crate::model::{Model, number};

pub(super) fn identity(model: &Model<'_>, found: &mut Found) {
    let root = model.root;
    if root.attribute("guid").is_some_and(|guid| guid.trim().is_empty()) {
        found.error_at(
            root.line,
            "the guid is empty: it tells whether library and description belong together",
        );
    }
    if root.attribute("modelName").is_some_and(|name| name.trim().is_empty()) {
        found.warning_at(root.line, "the modelName is empty");
    }
    let kinds = ["CoSimulation", "ModelExchange"].iter().filter_map(|kind| root.child(kind));
    for kind in kinds {
        let Some(identifier) = kind.attribute("modelIdentifier") else { continue };
        let begins = identifier.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
        if !begins || !identifier.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
            let expected = "letters, digits and underscores, a digit not first";
            found.error_at(
                kind.line,
                format!("modelIdentifier=\"{identifier}\" is no C identifier: {expected}"),
            );
        }
    }
    for kind in ["CoSimulation", "ModelExchange"] {
        let mut all = root.children.iter().filter(|child| child.name == kind).skip(1);
        if let Some(second) = all.next() {
            found.error_at(second.line, format!("a second <{kind}>"));
        }
    }
    if model.co_simulation.is_none() {
        found.note(
            "it is for model exchange only; this master can't run it, so the rules that run it are left out",
        );
    }
}

pub(super) fn capabilities(model: &Model<'_>, found: &mut Found) {
    let kinds = ["CoSimulation", "ModelExchange"].iter().filter_map(|kind| model.root.child(kind));
    for kind in kinds {
        if kind.flag("canSerializeFMUstate") && !kind.flag("canGetAndSetFMUstate") {
            found.error_at(kind.line, "canSerializeFMUstate needs canGetAndSetFMUstate");
        }
    }
    if let Some(kind) = model.co_simulation {
        if kind.flag("canRunAsynchronuously") {
            found.warning_at(
                kind.line,
                "canRunAsynchronuously: few masters, and not this one, wait for a pending step",
            );
        }
        if kind.flag("needsExecutionTool") {
            found.warning_at(kind.line, "needsExecutionTool: it runs only where its tool is installed");
        }
        if kind.flag("canBeInstantiatedOnlyOncePerProcess") {
            found.note("it can be instantiated only once per process: run its instances isolated");
        }
    }
}

pub(super) fn default_experiment(model: &Model<'_>, found: &mut Found) {
    let Some(element) = model.root.child("DefaultExperiment") else {
        return found
            .note("it has no DefaultExperiment: a master must guess for how long and how finely to run it");
    };
    let value = |name: &str| element.attribute(name).and_then(number);
    let line = element.line;
    for name in ["startTime", "stopTime", "tolerance", "stepSize"] {
        if let Some(value) = value(name).filter(|value| !value.is_finite()) {
            found.error_at(line, format!("{name}=\"{value}\": wanted is a finite number"));
        }
    }
    let start = value("startTime").unwrap_or(0.0);
    if let Some(stop) = value("stopTime").filter(|stop| *stop <= start) {
        found.error_at(line, format!("stopTime {stop} is not after startTime {start}"));
    }
    for name in ["stepSize", "tolerance"] {
        if let Some(value) = value(name).filter(|value| *value <= 0.0) {
            found.error_at(line, format!("{name}=\"{value}\": wanted is more than 0"));
        }
    }
    if let (Some(step), Some(stop)) = (value("stepSize"), value("stopTime"))
        && stop > start
        && step > stop - start
    {
        found.warning_at(
            line,
            format!("stepSize {step} is longer than the whole experiment, {}", stop - start),
        );
    }
}
