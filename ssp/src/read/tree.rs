//! The elements of a system: components, systems within systems, signal dictionaries, in the order of the documents.

use super::document::Document;
use super::source::resolve;
use crate::Error;
use orchestrator::fmu::Description;
use orchestrator::package::Package;
use orchestrator::suggest::nearest;
use orchestrator::xml::Element;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Systems nest as deep at most; a document that refers to itself would have no end.
const DEEPEST: usize = 32;
/// And have as many elements, with all that they bring: documents that each name the next one twice double with each.
const MOST: usize = 65_536;

/// What an element is.
pub(super) enum Kind {
    /// A unit: its place in [`Tree::components`].
    Component(usize),
    /// A system; its connectors are passages.
    System,
    /// A signal dictionary; its entries are passages.
    Dictionary,
}

/// Which way a connector looks, from inside the system that its element lies in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// Values come out of it.
    Source,
    /// Values go into it.
    Sink,
    /// Not said: what it is connected to decides.
    Either,
}

/// A connector.
pub(super) struct Connector {
    pub(super) way: Way,
    /// Name of the physical unit.
    pub(super) unit: Option<String>,
}

/// An element.
pub(super) struct Node {
    /// Names from the outermost system, which has none itself, with slashes between.
    pub(super) path: String,
    pub(super) kind: Kind,
    pub(super) depth: usize,
    pub(super) connectors: HashMap<String, Connector>,
    /// Its elements by name, if it is a system.
    pub(super) children: BTreeMap<String, usize>,
    /// Systems, and what else has parts in a document: the document and its element, with the name of the document.
    pub(super) parts: Vec<Part>,
}

/// An element of a document that belongs to a node: a component that stands for another document has two.
#[derive(Clone)]
pub(super) struct Part {
    pub(super) document: Rc<Document>,
    pub(super) element: Rc<Element>,
    /// The package, and the document's name in it.
    pub(super) package: Rc<str>,
    pub(super) base: Rc<str>,
}

/// A unit.
pub(super) struct Component {
    pub(super) node: usize,
    /// `package.ssp#resources/unit.fmu`
    pub(super) fmu: String,
    pub(super) description: Rc<Description>,
    pub(super) part: Part,
}

/// All elements; the first one is the outermost system.
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) components: Vec<Component>,
    pub(super) packages: HashMap<Rc<str>, Package>,
    descriptions: HashMap<String, Rc<Description>>,
    /// Where the outermost package lies.
    folder: PathBuf,
}

impl Tree {
    /// Reads the tree below a document's system. Scenarios name the package by `name`, it is opened by `path`.
    pub(super) fn read(
        package: Package,
        name: &Path,
        path: &Path,
        document: Rc<Document>,
    ) -> Result<Self, Error> {
        let name: Rc<str> = name.to_string_lossy().into();
        let mut tree = Self {
            nodes: Vec::new(),
            components: Vec::new(),
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            packages: HashMap::from([(name.clone(), package)]),
            descriptions: HashMap::new(),
        };
        let root = system_of(&document)?;
        let part = Part { element: root, document, package: name, base: super::MAIN.into() };
        let top = tree.add(String::new(), Kind::System, 0, part.clone())?;
        tree.system(top, &part, &BTreeMap::new())?;
        Ok(tree)
    }

    fn add(&mut self, path: String, kind: Kind, depth: usize, part: Part) -> Result<usize, Error> {
        if self.nodes.len() >= MOST {
            let what = format!("element {path} is one of more than {MOST}");
            return Err(part.document.wrong(
                &part.element,
                what,
                format!("{MOST} at most, with those of all documents that are named"),
            ));
        }
        let connectors = connectors(&part)?;
        let children = BTreeMap::new();
        self.nodes.push(Node { path, kind, depth, connectors, children, parts: vec![part] });
        Ok(self.nodes.len() - 1)
    }

    /// Reads what is in a system; `dictionaries` are those of the systems around it.
    fn system(
        &mut self,
        node: usize,
        part: &Part,
        dictionaries: &BTreeMap<String, usize>,
    ) -> Result<(), Error> {
        let depth = self.nodes[node].depth;
        if depth > DEEPEST {
            let what = format!("system {} lies {depth} systems deep", self.nodes[node].path);
            return Err(part.document.wrong(&part.element, what, format!("{DEEPEST} at most")));
        }
        let mut dictionaries = dictionaries.clone();
        for element in part.element.list("SignalDictionaries") {
            let name = part.document.required(element, "name")?.to_owned();
            let own = Part { element: Rc::new(empty(element)), ..part.clone() };
            let dictionary = self.add(String::new(), Kind::Dictionary, depth, own)?;
            dictionaries.insert(name, dictionary);
        }
        for element in part.element.list("Elements") {
            let own = Part { element: Rc::new(element.clone()), ..part.clone() };
            self.element(node, own, &dictionaries)?;
        }
        Ok(())
    }

    fn element(
        &mut self,
        within: usize,
        part: Part,
        dictionaries: &BTreeMap<String, usize>,
    ) -> Result<(), Error> {
        let (document, element) = (part.document.clone(), part.element.clone());
        let name = document.required(&element, "name")?.to_owned();
        if let Some(first) = self.nodes[within].children.get(&name) {
            let first = document.place(&self.nodes[*first].parts[0].element);
            let expected = format!("another name: the first one is at {first}");
            return Err(document.wrong(&element, format!("a second element {name:?}"), expected));
        }
        let (around, depth) = (self.nodes[within].path.clone(), self.nodes[within].depth + 1);
        let path = if around.is_empty() { name.clone() } else { format!("{around}/{name}") };
        let node = match element.name.as_str() {
            "System" => {
                let node = self.add(path, Kind::System, depth, part.clone())?;
                self.system(node, &part, dictionaries)?;
                node
            }
            "SignalDictionaryReference" => {
                let wanted = document.required(&element, "dictionary")?;
                let dictionary = *dictionaries.get(wanted).ok_or_else(|| {
                    let known = nearest(wanted, dictionaries.keys().map(String::as_str));
                    document.wrong(
                        &element,
                        format!("{path}: there is no signal dictionary {wanted:?}"),
                        known,
                    )
                })?;
                // Its connectors are the dictionary's own: what goes into one reference comes out of the others.
                self.nodes[dictionary].connectors.extend(connectors(&part)?);
                dictionary
            }
            "Component" => self.component(path, depth, part)?,
            other => {
                let expected = "Component, System or SignalDictionaryReference";
                return Err(document.wrong(&element, format!("<{other}> in <Elements>"), expected));
            }
        };
        self.nodes[within].children.insert(name, node);
        Ok(())
    }

    fn component(&mut self, path: String, depth: usize, part: Part) -> Result<usize, Error> {
        let (document, element) = (part.document.clone(), part.element.clone());
        let wrong = |what: String, expected: &str| document.wrong(&element, what, expected);
        let source = element.attribute("source").ok_or_else(|| {
            wrong(
                format!("component {path} without source"),
                "source=\"resources/UNIT.fmu\": only a unit can be run",
            )
        })?;
        let entry = resolve(&document, &element, &part.base, source)?;
        let node = self.add(path.clone(), Kind::System, depth, part.clone())?;
        match element.attribute("type").unwrap_or("application/x-fmu-sharedlibrary") {
            "application/x-fmu-sharedlibrary" => {}
            "application/x-ssp-definition" => {
                let inner = self.open(&part.package, &entry)?;
                self.nest(node, inner, part.package, &entry)?;
                return Ok(node);
            }
            "application/x-ssp-package" => {
                let package: Rc<str> = format!("{}#{entry}", part.package).into();
                if !self.packages.contains_key(&package) {
                    let opened = Package::open(&self.folder.join(&*package))?;
                    self.packages.insert(package.clone(), opened);
                }
                let inner = self.open(&package, super::MAIN)?;
                self.nest(node, inner, package, super::MAIN)?;
                return Ok(node);
            }
            other => {
                let expected = "application/x-fmu-sharedlibrary, application/x-ssp-definition or application/x-ssp-package";
                return Err(wrong(format!("component {path} of type {other:?}"), expected));
            }
        }
        let implementation = element.attribute("implementation").unwrap_or("any");
        if !["any", "CoSimulation", "ModelExchange", "ScheduledExecution"].contains(&implementation) {
            let expected = "any, CoSimulation or ModelExchange";
            return Err(wrong(
                format!("component {path} with implementation=\"{implementation}\""),
                expected,
            ));
        }
        let fmu = format!("{}#{entry}", part.package);
        let closed = || wrong(format!("component {path}"), "an open package");
        let description = self.description(&part.package, &entry, &fmu, closed)?;
        self.nodes[node].kind = Kind::Component(self.components.len());
        self.components.push(Component { node, fmu, description, part });
        Ok(node)
    }

    /// The description of a unit, read once; `closed` where its package is none of the open ones.
    fn description(
        &mut self,
        package: &str,
        entry: &str,
        fmu: &str,
        closed: impl Fn() -> Error,
    ) -> Result<Rc<Description>, Error> {
        if let Some(known) = self.descriptions.get(fmu) {
            return Ok(known.clone());
        }
        let package = self.packages.get_mut(package).ok_or_else(closed)?;
        let described = Rc::new(package.describe(entry)?);
        self.descriptions.insert(fmu.to_owned(), described.clone());
        Ok(described)
    }

    fn open(&mut self, package: &str, entry: &str) -> Result<Rc<Document>, Error> {
        let Some(package) = self.packages.get_mut(package) else {
            return Err(Error::Scenario {
                what: format!("package {package}"),
                expected: "an open package".into(),
            });
        };
        Document::open(package, entry, "SystemStructureDescription").map(Rc::new)
    }

    /// Puts another document's system in a component's place.
    fn nest(&mut self, node: usize, inner: Rc<Document>, package: Rc<str>, base: &str) -> Result<(), Error> {
        let part = Part { element: system_of(&inner)?, document: inner, package, base: base.into() };
        let own = connectors(&part)?;
        self.nodes[node].connectors.extend(own);
        // The component's parameter bindings come after those of the system that it stands for.
        self.nodes[node].parts.insert(0, part.clone());
        self.system(node, &part, &BTreeMap::new())
    }
}

fn system_of(document: &Rc<Document>) -> Result<Rc<Element>, Error> {
    match document.root.child("System") {
        Some(system) => Ok(Rc::new(system.clone())),
        None => Err(document.wrong(&document.root, "no <System>", "one, with its elements and connections")),
    }
}

/// The element without what is in it: a dictionary's entries are known by the references to it.
fn empty(element: &Element) -> Element {
    let mut copy = element.clone();
    copy.children.clear();
    copy
}

fn connectors(part: &Part) -> Result<HashMap<String, Connector>, Error> {
    let Part { document, element, .. } = part;
    let mut all = HashMap::new();
    for connector in element.list("Connectors").iter().filter(|child| child.name == "Connector") {
        let name = document.required(connector, "name")?.to_owned();
        let way = match document.required(connector, "kind")? {
            "input" | "parameter" | "structuralParameter" => Way::Sink,
            "output" | "calculatedParameter" | "local" | "constant" => Way::Source,
            "inout" | "unspecified" => Way::Either,
            other => {
                let expected = nearest(
                    other,
                    ["input", "output", "parameter", "calculatedParameter", "inout"].into_iter(),
                );
                return Err(document.wrong(
                    connector,
                    format!("kind=\"{other}\" of connector {name}"),
                    expected,
                ));
            }
        };
        let typed = connector.children.iter().find(|child| child.name != "Annotations");
        let unit = typed.and_then(|typed| typed.attribute("unit")).filter(|unit| !unit.is_empty());
        let unit = unit.or_else(|| connector.attribute("unit")).map(str::to_owned);
        if all.insert(name.clone(), Connector { way, unit }).is_some() {
            let element = element.attribute("name").unwrap_or_default();
            return Err(document.wrong(
                connector,
                format!("a second connector {name:?} of {element}"),
                "each name once",
            ));
        }
    }
    Ok(all)
}

impl Tree {
    /// The same with its definition by the component's unit, where nobody else has one.
    pub(super) fn defined(
        &self,
        node: usize,
        (name, base): (Option<String>, Option<orchestrator::fmu::BaseUnit>),
    ) -> (Option<String>, Option<orchestrator::fmu::BaseUnit>) {
        let by_unit = || match self.nodes[node].kind {
            Kind::Component(component) => self.components[component].description.unit(name.as_deref()?)?.base,
            _ => None,
        };
        let base = base.or_else(by_unit);
        (name, base)
    }

    /// The definition of a physical unit that a connector names: the document's own, else that of the component's unit.
    pub(super) fn unit(
        &self,
        node: usize,
        connector: &str,
    ) -> (Option<String>, Option<orchestrator::fmu::BaseUnit>) {
        let node = &self.nodes[node];
        let declared = node.connectors.get(connector).and_then(|connector| connector.unit.clone());
        let in_documents =
            |name: &String| node.parts.iter().find_map(|part| part.document.units.get(name).copied());
        let Kind::Component(component) = node.kind else {
            let base = declared.as_ref().and_then(in_documents);
            return (declared, base);
        };
        let description = &self.components[component].description;
        let own = || description.variable(connector)?.unit.clone();
        let Some(name) = declared.or_else(own) else { return (None, None) };
        let base = in_documents(&name).or_else(|| description.unit(&name)?.base);
        (Some(name), base)
    }
}
