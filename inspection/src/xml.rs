//! The whole of a description as a tree: elements, attributes and lines, nothing passed over but the contents of
//! annotations, which are their tools' own.

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};

/// One element.
#[derive(Debug)]
pub(crate) struct Element {
    /// Without prefix.
    pub(crate) name: String,
    pub(crate) line: usize,
    /// Those without prefix.
    pub(crate) attributes: Vec<(String, String)>,
    pub(crate) children: Vec<Element>,
    /// Text that stands in it, the first that is no blank: its line, and what it is.
    pub(crate) text: Option<(usize, String)>,
}

/// Line, what is wrong.
pub(crate) type Fault = (usize, String);

/// Elements of a description nest five deep. Dropping a tree goes as deep as the tree.
const DEEPEST: usize = 100;
/// The element in which anything may stand.
const FREE: &str = "Tool";

impl Element {
    /// Parses a document and returns its root.
    pub(crate) fn parse(text: &str) -> Result<Self, Fault> {
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = quick_xml::Reader::from_str(text);
        let mut lines = Lines { text: text.as_bytes(), at: 0, line: 1 };
        let mut open: Vec<Element> = Vec::new();
        let mut root = None;
        // How many elements are open inside an annotation; they may nest as deep as they like.
        let mut passed_over = 0u64;
        loop {
            let event = reader.read_event();
            let line = lines.at(reader.buffer_position() as usize);
            let free = open.last().is_some_and(|parent| parent.name == FREE);
            let event = event.map_err(|error| (line, error.to_string()))?;
            note_text(&event, open.last_mut(), line);
            let done = match event {
                Event::Start(_) if free => {
                    passed_over += 1;
                    continue;
                }
                Event::Empty(_) if free => continue,
                Event::End(_) if passed_over > 0 => {
                    passed_over -= 1;
                    continue;
                }
                Event::Start(_) | Event::Empty(_) if root.is_some() => {
                    return Err((line, "a second element follows the root".into()));
                }
                Event::Start(_) if open.len() == DEEPEST => {
                    return Err((line, format!("elements nest more than {DEEPEST} deep")));
                }
                Event::Start(start) => {
                    open.push(element(&start, line)?);
                    continue;
                }
                Event::Empty(start) => element(&start, line)?,
                Event::End(_) => open.pop().ok_or((line, "an element ends that never began".to_owned()))?,
                Event::Eof => break,
                _ => continue,
            };
            match open.last_mut() {
                Some(parent) => parent.children.push(done),
                None => root = Some(done),
            }
        }
        whole(open.last(), root)
    }

    /// An attribute.
    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// An attribute that reads as a number of some type; one that does not is a finding of the rule `schema`.
    pub(crate) fn number<T: std::str::FromStr>(&self, name: &str) -> Option<T> {
        self.attribute(name)?.trim().parse().ok()
    }

    /// A Boolean attribute; false where there is none.
    pub(crate) fn flag(&self, name: &str) -> bool {
        matches!(self.attribute(name).map(str::trim), Some("true" | "1"))
    }

    /// The first child of a name.
    pub(crate) fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The children with a name of the first child of another.
    pub(crate) fn list<'a>(&'a self, name: &str, items: &'a str) -> impl Iterator<Item = &'a Element> {
        let children = self.child(name).map_or(&[][..], |child| &child.children);
        children.iter().filter(move |child| child.name == items)
    }
}

/// The root, if all that began has ended.
fn whole(open: Option<&Element>, root: Option<Element>) -> Result<Element, Fault> {
    match (open, root) {
        (None, Some(root)) => Ok(root),
        (Some(open), _) => Err((open.line, format!("<{}> begins here and does not end", open.name))),
        (None, None) => Err((1, "there is no element".into())),
    }
}

/// Keeps the first text of an element in which only elements may stand; blanks are none. `line` is that of its end.
fn note_text(event: &Event<'_>, element: Option<&mut Element>, line: usize) {
    let text: &str = match event {
        Event::Text(text) => text,
        Event::CData(text) => text,
        _ => return,
    };
    let element = element.filter(|element| element.text.is_none() && element.name != FREE);
    if let (Some(element), false) = (element, text.trim().is_empty()) {
        let line = line - text.trim_start().matches('\n').count();
        element.text = Some((line, text.trim().to_owned()));
    }
}

fn element(start: &BytesStart<'_>, line: usize) -> Result<Element, Fault> {
    let mut attributes = Vec::new();
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|error| (line, error.to_string()))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0);
        let value = value.map_err(|error| (line, error.to_string()))?;
        let key: &str = attribute.key.as_ref();
        // Prefixed ones (`xmlns:xsi`, `xsi:…`) belong to XML, not to FMI.
        if !key.contains(':') && key != "xmlns" {
            attributes.push((key.to_owned(), value.into_owned()));
        }
    }
    let name: &str = start.name().local_name().into_inner();
    Ok(Element { name: name.to_owned(), line, attributes, children: Vec::new(), text: None })
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
