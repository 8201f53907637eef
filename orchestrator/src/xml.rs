//! A small tree of XML elements: names without prefixes, attributes, lines. What a description says is read off it.

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};

/// One element.
#[derive(Debug, Clone)]
pub struct Element {
    /// Its name without a prefix.
    pub name: String,
    /// Line of the document, from 1.
    pub line: usize,
    attributes: Vec<(String, String)>,
    /// What is in it.
    pub children: Vec<Element>,
}

impl Element {
    /// Parses a document and returns its root, without elements (and what is in them) whose names are not listed; an
    /// error is (line, what). The root is kept whatever its name is.
    ///
    /// # Errors
    /// If it is no XML, or nests too deep.
    pub fn parse_known(text: &str, known: &[&str]) -> Result<Self, (usize, String)> {
        // A byte order mark is legal before the declaration.
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = quick_xml::Reader::from_str(text);
        let mut open: Vec<Element> = Vec::new();
        let mut lines = Lines { text: text.as_bytes(), at: 0, line: 1 };
        // How many elements are open that are not kept; they may nest as deep as they like.
        let mut passed_over = 0u64;
        loop {
            let event = reader.read_event();
            let line = lines.at(reader.buffer_position() as usize);
            match event.map_err(|e| (line, e.to_string()))? {
                Event::Start(_) if passed_over > 0 => passed_over += 1,
                Event::End(_) if passed_over > 0 => passed_over -= 1,
                Event::Empty(_) if passed_over > 0 => {}
                Event::Start(start) => match open.is_empty() || is_known(&start, known) {
                    true if open.len() == DEEPEST => {
                        return Err((line, format!("elements nest more than {DEEPEST} deep")));
                    }
                    true => open.push(element(&start, line)?),
                    false => passed_over = 1,
                },
                Event::Empty(start) if open.is_empty() || is_known(&start, known) => {
                    let done = element(&start, line)?;
                    match open.last_mut() {
                        Some(parent) => parent.children.push(done),
                        None => return Ok(done),
                    }
                }
                Event::End(_) => {
                    let Some(done) = open.pop() else {
                        return Err((line, "an element ends that never began".into()));
                    };
                    match open.last_mut() {
                        Some(parent) => parent.children.push(done),
                        None => return Ok(done),
                    }
                }
                Event::Eof => return Err((line, "the document ends inside an element".into())),
                _ => {}
            }
        }
    }

    /// An attribute by its name without prefix.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The first child of a name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The children of the first child of a name: `ModelVariables`' variables, for example.
    pub fn list(&self, name: &str) -> &[Element] {
        self.child(name).map_or(&[], |child| &child.children)
    }
}

/// Elements of a description nest five deep. Dropping a tree goes as deep as the tree.
const DEEPEST: usize = 100;

fn is_known(start: &BytesStart<'_>, known: &[&str]) -> bool {
    let name: &str = start.name().local_name().into_inner();
    known.contains(&name)
}

fn element(start: &BytesStart<'_>, line: usize) -> Result<Element, (usize, String)> {
    let mut attributes = Vec::new();
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|e| (line, e.to_string()))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| (line, e.to_string()))?;
        let key: &str = attribute.key.as_ref();
        // Prefixed ones (`xmlns:xsi`, `xsi:…`) belong to XML, not to FMI.
        if !key.contains(':') {
            attributes.push((key.to_owned(), value.into_owned()));
        }
    }
    let name: &str = start.name().local_name().into_inner();
    Ok(Element { name: name.to_owned(), line, attributes, children: Vec::new() })
}

/// Counts lines as the reader goes on.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl Lines<'_> {
    fn at(&mut self, position: usize) -> usize {
        let position = position.min(self.text.len());
        self.line += self.text[self.at.min(position)..position].iter().filter(|&&byte| byte == b'\n').count();
        self.at = position;
        self.line
    }
}
