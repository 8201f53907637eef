//! The elements of a description, their order and their attributes.

/// What an attribute holds.
pub(super) enum Holds {
    Text,
    Double,
    Int,
    Unsigned,
    Boolean,
    DateTime,
    OneOf(&'static [&'static str]),
    Unsigneds,
    Kinds,
}
use Holds::{Boolean, DateTime, Double, Int, Kinds, OneOf, Text, Unsigned, Unsigneds};

pub(super) struct Attribute {
    pub(super) name: &'static str,
    pub(super) holds: Holds,
    pub(super) needed: bool,
}

const fn may(name: &'static str, holds: Holds) -> Attribute {
    Attribute { name, holds, needed: false }
}

const fn must(name: &'static str, holds: Holds) -> Attribute {
    Attribute { name, holds, needed: true }
}

/// Elements of which so many stand at one place.
pub(super) struct Group {
    pub(super) of: &'static [&'static Shape],
    pub(super) least: usize,
    pub(super) most: usize,
}

const MANY: usize = usize::MAX;

const fn group(of: &'static [&'static Shape], least: usize, most: usize) -> Group {
    Group { of, least, most }
}

/// An element.
pub(super) struct Shape {
    pub(super) name: &'static str,
    pub(super) attributes: &'static [Attribute],
    /// In the order in which they stand.
    pub(super) children: &'static [Group],
}

const fn leaf(name: &'static str, attributes: &'static [Attribute]) -> Shape {
    Shape { name, attributes, children: &[] }
}

pub(super) static ROOT: Shape = Shape {
    name: "fmiModelDescription",
    attributes: &[
        must("fmiVersion", Text),
        must("modelName", Text),
        must("guid", Text),
        may("description", Text),
        may("author", Text),
        may("version", Text),
        may("copyright", Text),
        may("license", Text),
        may("generationTool", Text),
        may("generationDateAndTime", DateTime),
        may("variableNamingConvention", OneOf(&["flat", "structured"])),
        may("numberOfEventIndicators", Unsigned),
    ],
    children: &[
        group(&[&MODEL_EXCHANGE, &CO_SIMULATION], 1, 2),
        group(&[&UNIT_DEFINITIONS], 0, 1),
        group(&[&TYPE_DEFINITIONS], 0, 1),
        group(&[&LOG_CATEGORIES], 0, 1),
        group(&[&DEFAULT_EXPERIMENT], 0, 1),
        group(&[&VENDOR_ANNOTATIONS], 0, 1),
        group(&[&MODEL_VARIABLES], 1, 1),
        group(&[&MODEL_STRUCTURE], 1, 1),
    ],
};
static MODEL_EXCHANGE: Shape = Shape {
    name: "ModelExchange",
    attributes: &[
        must("modelIdentifier", Text),
        may("needsExecutionTool", Boolean),
        may("completedIntegratorStepNotNeeded", Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Boolean),
        may("canNotUseMemoryManagementFunctions", Boolean),
        may("canGetAndSetFMUstate", Boolean),
        may("canSerializeFMUstate", Boolean),
        may("providesDirectionalDerivative", Boolean),
    ],
    children: &[group(&[&SOURCE_FILES], 0, 1)],
};
static CO_SIMULATION: Shape = Shape {
    name: "CoSimulation",
    attributes: &[
        must("modelIdentifier", Text),
        may("needsExecutionTool", Boolean),
        may("canHandleVariableCommunicationStepSize", Boolean),
        may("canInterpolateInputs", Boolean),
        may("maxOutputDerivativeOrder", Unsigned),
        may("canRunAsynchronuously", Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Boolean),
        may("canNotUseMemoryManagementFunctions", Boolean),
        may("canGetAndSetFMUstate", Boolean),
        may("canSerializeFMUstate", Boolean),
        may("providesDirectionalDerivative", Boolean),
    ],
    children: &[group(&[&SOURCE_FILES], 0, 1)],
};
static SOURCE_FILES: Shape =
    Shape { name: "SourceFiles", attributes: &[], children: &[group(&[&FILE], 1, MANY)] };
static FILE: Shape = leaf("File", &[must("name", Text)]);
static UNIT_DEFINITIONS: Shape =
    Shape { name: "UnitDefinitions", attributes: &[], children: &[group(&[&UNIT], 1, MANY)] };
static UNIT: Shape = Shape {
    name: "Unit",
    attributes: &[must("name", Text)],
    children: &[group(&[&BASE_UNIT], 0, 1), group(&[&DISPLAY_UNIT], 0, MANY)],
};
static BASE_UNIT: Shape = leaf(
    "BaseUnit",
    &[
        may("kg", Int),
        may("m", Int),
        may("s", Int),
        may("A", Int),
        may("K", Int),
        may("mol", Int),
        may("cd", Int),
        may("rad", Int),
        may("factor", Double),
        may("offset", Double),
    ],
);
static DISPLAY_UNIT: Shape =
    leaf("DisplayUnit", &[must("name", Text), may("factor", Double), may("offset", Double)]);
static TYPE_DEFINITIONS: Shape =
    Shape { name: "TypeDefinitions", attributes: &[], children: &[group(&[&SIMPLE_TYPE], 1, MANY)] };
static SIMPLE_TYPE: Shape = Shape {
    name: "SimpleType",
    attributes: &[must("name", Text), may("description", Text)],
    children: &[group(&[&TYPE_REAL, &TYPE_INTEGER, &TYPE_BOOLEAN, &TYPE_STRING, &TYPE_ENUMERATION], 1, 1)],
};
static TYPE_REAL: Shape = leaf(
    "Real",
    &[
        may("quantity", Text),
        may("unit", Text),
        may("displayUnit", Text),
        may("relativeQuantity", Boolean),
        may("min", Double),
        may("max", Double),
        may("nominal", Double),
        may("unbounded", Boolean),
    ],
);
static TYPE_INTEGER: Shape = leaf("Integer", &[may("quantity", Text), may("min", Int), may("max", Int)]);
static TYPE_BOOLEAN: Shape = leaf("Boolean", &[]);
static TYPE_STRING: Shape = leaf("String", &[]);
static TYPE_ENUMERATION: Shape = Shape {
    name: "Enumeration",
    attributes: &[may("quantity", Text)],
    children: &[group(&[&ITEM], 1, MANY)],
};
static ITEM: Shape = leaf("Item", &[must("name", Text), must("value", Int), may("description", Text)]);
static LOG_CATEGORIES: Shape =
    Shape { name: "LogCategories", attributes: &[], children: &[group(&[&CATEGORY], 1, MANY)] };
static CATEGORY: Shape = leaf("Category", &[must("name", Text), may("description", Text)]);
static DEFAULT_EXPERIMENT: Shape = leaf(
    "DefaultExperiment",
    &[may("startTime", Double), may("stopTime", Double), may("tolerance", Double), may("stepSize", Double)],
);
static VENDOR_ANNOTATIONS: Shape =
    Shape { name: "VendorAnnotations", attributes: &[], children: &[group(&[&TOOL], 1, MANY)] };
static ANNOTATIONS: Shape =
    Shape { name: "Annotations", attributes: &[], children: &[group(&[&TOOL], 1, MANY)] };
static TOOL: Shape = leaf("Tool", &[must("name", Text)]);
static MODEL_VARIABLES: Shape =
    Shape { name: "ModelVariables", attributes: &[], children: &[group(&[&SCALAR_VARIABLE], 1, MANY)] };
static SCALAR_VARIABLE: Shape = Shape {
    name: "ScalarVariable",
    attributes: &[
        must("name", Text),
        must("valueReference", Unsigned),
        may("description", Text),
        may(
            "causality",
            OneOf(&["parameter", "calculatedParameter", "input", "output", "local", "independent"]),
        ),
        may("variability", OneOf(&["constant", "fixed", "tunable", "discrete", "continuous"])),
        may("initial", OneOf(&["exact", "approx", "calculated"])),
        may("canHandleMultipleSetPerTimeInstant", Boolean),
    ],
    children: &[
        group(&[&REAL, &INTEGER, &BOOLEAN, &STRING, &ENUMERATION], 1, 1),
        group(&[&ANNOTATIONS], 0, 1),
    ],
};
static REAL: Shape = leaf(
    "Real",
    &[
        may("declaredType", Text),
        may("quantity", Text),
        may("unit", Text),
        may("displayUnit", Text),
        may("relativeQuantity", Boolean),
        may("min", Double),
        may("max", Double),
        may("nominal", Double),
        may("unbounded", Boolean),
        may("start", Double),
        may("derivative", Unsigned),
        may("reinit", Boolean),
    ],
);
static INTEGER: Shape = leaf(
    "Integer",
    &[may("declaredType", Text), may("quantity", Text), may("min", Int), may("max", Int), may("start", Int)],
);
static BOOLEAN: Shape = leaf("Boolean", &[may("declaredType", Text), may("start", Boolean)]);
static STRING: Shape = leaf("String", &[may("declaredType", Text), may("start", Text)]);
static ENUMERATION: Shape = leaf(
    "Enumeration",
    &[must("declaredType", Text), may("quantity", Text), may("min", Int), may("max", Int), may("start", Int)],
);
static MODEL_STRUCTURE: Shape = Shape {
    name: "ModelStructure",
    attributes: &[],
    children: &[group(&[&OUTPUTS], 0, 1), group(&[&DERIVATIVES], 0, 1), group(&[&INITIAL_UNKNOWNS], 0, 1)],
};
static OUTPUTS: Shape = Shape { name: "Outputs", attributes: &[], children: &[group(&[&UNKNOWN], 1, MANY)] };
static DERIVATIVES: Shape =
    Shape { name: "Derivatives", attributes: &[], children: &[group(&[&UNKNOWN], 1, MANY)] };
static INITIAL_UNKNOWNS: Shape =
    Shape { name: "InitialUnknowns", attributes: &[], children: &[group(&[&UNKNOWN], 1, MANY)] };
static UNKNOWN: Shape = leaf(
    "Unknown",
    &[must("index", Unsigned), may("dependencies", Unsigneds), may("dependenciesKind", Kinds)],
);
