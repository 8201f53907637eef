//! One XML document of a package, and errors that name its lines.

use crate::Error;
use orchestrator::fmu::BaseUnit;
use orchestrator::package::Package;
use orchestrator::{Place, xml::Element};
use std::collections::HashMap;
use std::sync::Arc;

/// The elements that are read; others, as pictures and signatures, are passed over with what is in them.
const KNOWN: &[&str] = &[
    "SystemStructureDescription",
    "System",
    "Component",
    "SignalDictionaryReference",
    "SignalDictionaries",
    "SignalDictionary",
    "Elements",
    "Connectors",
    "Connector",
    "Connections",
    "Connection",
    "ParameterBindings",
    "ParameterBinding",
    "ParameterValues",
    "ParameterSet",
    "Parameters",
    "Parameter",
    "ParameterMapping",
    "MappingEntry",
    "LinearTransformation",
    "BooleanMappingTransformation",
    "IntegerMappingTransformation",
    "EnumerationMappingTransformation",
    "MapEntry",
    "Units",
    "Unit",
    "BaseUnit",
    "Enumerations",
    "Enumeration",
    "Item",
    "Real",
    "Float64",
    "Float32",
    "Integer",
    "Int8",
    "UInt8",
    "Int16",
    "UInt16",
    "Int32",
    "UInt32",
    "Int64",
    "UInt64",
    "Boolean",
    "String",
    "Binary",
    "Dimension",
    "DefaultExperiment",
    "Annotations",
    "Annotation",
    // OMSimulator's and libcosim's times.
    "SimulationInformation",
    "FixedStepMaster",
    "VariableStepMaster",
    "Algorithm",
    "FixedStepAlgorithm",
    "StepSizeHint",
    crate::annotation::UNIT,
    crate::annotation::CONNECTION,
    crate::annotation::EXPERIMENT,
    crate::annotation::OPTION,
    crate::annotation::RECORD,
    crate::annotation::SOURCE,
    crate::annotation::REPORT,
];

/// A document and what it defines.
pub(super) struct Document {
    /// `package.ssp/SystemStructure.ssd`
    pub(super) file: Arc<str>,
    pub(super) root: Element,
    pub(super) units: HashMap<String, BaseUnit>,
}

impl Document {
    /// Reads one of a package's documents, whose root must have a name and a version that is known.
    pub(super) fn open(package: &mut Package, entry: &str, root: &str) -> Result<Self, Error> {
        let file: Arc<str> = format!("{}/{entry}", package.path().display()).into();
        let text = package.read_text(entry)?;
        let wrong = |(line, what)| Error::Document {
            place: Place::Line { file: file.clone(), line },
            what,
            expected: format!("an XML document of <{root}>"),
        };
        let element = Element::parse_known(&text, KNOWN).map_err(wrong)?;
        let mut document = Self { file, root: element, units: HashMap::new() };
        document.check(&document.root, root)?;
        document.units = units(&document, &document.root)?;
        Ok(document)
    }

    /// Whether an element is the root of what is expected there, in a known version.
    pub(super) fn check(&self, element: &Element, root: &str) -> Result<(), Error> {
        if element.name != root {
            return Err(self.wrong(element, format!("<{}>", element.name), format!("<{root}>")));
        }
        match element.attribute("version").map(str::trim) {
            // Drafts of 1.1 and 2.0 are called so by tools that were there before the standard.
            Some("1.0" | "1.1" | "2.0") => Ok(()),
            Some(other) => Err(self.wrong(
                element,
                format!("version=\"{other}\" of <{root}>"),
                "this program reads versions 1.0 and 2.0",
            )),
            None => {
                Err(self.wrong(element, format!("<{root}> without version"), "version=\"1.0\" or \"2.0\""))
            }
        }
    }

    pub(super) fn place(&self, element: &Element) -> Place {
        Place::Line { file: self.file.clone(), line: element.line }
    }

    pub(super) fn wrong(
        &self,
        element: &Element,
        what: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::Document { place: self.place(element), what: what.into(), expected: expected.into() }
    }

    pub(super) fn required<'a>(&self, element: &'a Element, name: &str) -> Result<&'a str, Error> {
        element.attribute(name).ok_or_else(|| {
            self.wrong(element, format!("<{}> without {name}", element.name), format!("{name}=\"...\""))
        })
    }

    /// A finite number; `None` where the attribute is not there.
    pub(super) fn number(&self, element: &Element, name: &str) -> Result<Option<f64>, Error> {
        let Some(text) = element.attribute(name) else { return Ok(None) };
        let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let wrong =
            || self.wrong(element, format!("{name}=\"{text}\" of <{}>", element.name), "a finite number");
        number.map(Some).ok_or_else(wrong)
    }

    pub(super) fn flag(&self, element: &Element, name: &str) -> Result<bool, Error> {
        match element.attribute(name).map(str::trim) {
            None | Some("false" | "0") => Ok(false),
            Some("true" | "1") => Ok(true),
            Some(text) => {
                Err(self.wrong(element, format!("{name}=\"{text}\" of <{}>", element.name), "true or false"))
            }
        }
    }
}

/// The physical units that a root defines.
pub(super) fn units(document: &Document, root: &Element) -> Result<HashMap<String, BaseUnit>, Error> {
    let mut units = HashMap::new();
    for unit in root.list("Units").iter().filter(|element| element.name == "Unit") {
        let name = document.required(unit, "name")?.to_owned();
        let Some(base) = unit.child("BaseUnit") else { continue };
        let mut exponents = [0; 8];
        for (exponent, name) in exponents.iter_mut().zip(["kg", "m", "s", "A", "K", "mol", "cd", "rad"]) {
            let Some(text) = base.attribute(name) else { continue };
            let wrong = || document.wrong(base, format!("{name}=\"{text}\" of <BaseUnit>"), "an integer");
            *exponent = text.trim().parse().map_err(|_| wrong())?;
        }
        let factor = document.number(base, "factor")?.unwrap_or(1.0);
        if factor == 0.0 {
            let what = format!("factor=\"0\" of the unit {name}");
            return Err(document.wrong(base, what, "another factor: nothing could be converted back"));
        }
        let offset = document.number(base, "offset")?.unwrap_or(0.0);
        units.insert(name, BaseUnit { exponents, factor, offset });
    }
    Ok(units)
}

/// An element of a name anywhere within another one.
pub(super) fn find<'a>(within: &'a Element, name: &str) -> Option<&'a Element> {
    within.children.iter().find_map(|child| if child.name == name { Some(child) } else { find(child, name) })
}

/// One of our annotations on an element.
pub(super) fn ours<'a>(element: &'a Element, name: &str) -> Option<&'a Element> {
    (element.list("Annotations").iter())
        .filter(|annotation| annotation.attribute("type") == Some(crate::annotation::TYPE))
        .find_map(|annotation| annotation.child(name))
}
