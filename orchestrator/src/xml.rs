//! A small tree of XML elements: names without prefixes, attributes, lines. What a description says is read off it.
//!
//! A document need not fit the memory: [`Element::stream`] hands elements out as they end, and keeps what nobody takes.

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::io::{self, BufRead, BufReader, Read};

/// One element.
#[derive(Debug, Clone)]
pub struct Element {
    /// Its name without a prefix.
    pub name: String,
    /// Line of the document, from 1.
    pub line: usize,
    /// Keys and values of the attributes, one behind the other: one piece of memory an element.
    text: String,
    /// Where in it each key and its value end.
    attributes: Vec<(usize, usize)>,
    /// What is in it.
    pub children: Vec<Element>,
}

/// The line and what is wrong there.
type Fault = (usize, String);

impl Element {
    /// Parses a document and returns its root, without elements (and what is in them) whose names are not listed; an
    /// error is (line, what). The root is kept whatever its name is.
    ///
    /// # Errors
    /// If it is no XML, or nests too deep.
    pub fn parse_known(text: &str, known: &[&str]) -> Result<Self, (usize, String)> {
        Self::stream(text.as_bytes(), known, |_, element| Ok(Some(element)))
    }

    /// The same of what is read, which never lies in memory as a whole. Each element but the root goes with the name of
    /// its parent through `sieve` when it ends; the tree keeps what that gives back.
    ///
    /// # Errors
    /// If it can't be read, is no XML, nests too deep, or the sieve says so.
    pub fn stream(
        input: impl Read,
        known: &[&str],
        mut sieve: impl FnMut(&str, Element) -> Result<Option<Element>, (usize, String)>,
    ) -> Result<Self, (usize, String)> {
        let lines = Lines { input: BufReader::with_capacity(1 << 16, input), line: 1 };
        let mut reader = quick_xml::Reader::from_reader(lines);
        let mut buffer = Vec::new();
        let mut open: Vec<Element> = Vec::new();
        // How many elements are open that are not kept; they may nest as deep as they like.
        let mut passed_over = 0u64;
        loop {
            buffer.clear();
            let event = reader.read_event_into(&mut buffer);
            // What was read is as far as the event, or as far as what is wrong.
            let line = reader.get_ref().line;
            let done = match event.map_err(|error| (line, error.to_string()))? {
                Event::Start(_) if passed_over > 0 => {
                    passed_over += 1;
                    continue;
                }
                Event::End(_) if passed_over > 0 => {
                    passed_over -= 1;
                    continue;
                }
                Event::Empty(_) if passed_over > 0 => continue,
                Event::Start(start) => {
                    match open.is_empty() || is_known(&start, known) {
                        true if open.len() == DEEPEST => {
                            return Err((line, format!("elements nest more than {DEEPEST} deep")));
                        }
                        true => open.push(element(&start, line)?),
                        false => passed_over = 1,
                    }
                    continue;
                }
                Event::Empty(start) if open.is_empty() || is_known(&start, known) => element(&start, line)?,
                Event::End(_) => {
                    open.pop().ok_or_else(|| (line, "an element ends that never began".to_owned()))?
                }
                Event::Eof => return Err((line, "the document ends inside an element".into())),
                _ => continue,
            };
            let Some(parent) = open.last_mut() else { return Ok(done) };
            parent.children.extend(sieve(&parent.name, done)?);
        }
    }

    /// An attribute by its name without prefix.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let mut begin = 0;
        for &(key, value) in &self.attributes {
            if &self.text[begin..key] == name {
                return Some(&self.text[key..value]);
            }
            begin = value;
        }
        None
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

fn element(start: &BytesStart<'_>, line: usize) -> Result<Element, Fault> {
    let (mut text, mut attributes) = (String::with_capacity(start.len()), Vec::new());
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|e| (line, e.to_string()))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| (line, e.to_string()))?;
        let key: &str = attribute.key.as_ref();
        // Prefixed ones (`xmlns:xsi`, `xsi:…`) belong to XML, not to FMI.
        if !key.contains(':') {
            text.push_str(key);
            let ends = text.len();
            text.push_str(&value);
            attributes.push((ends, text.len()));
        }
    }
    let name: &str = start.name().local_name().into_inner();
    Ok(Element { name: name.to_owned(), line, text, attributes, children: Vec::new() })
}

/// Counts the lines of what was read.
struct Lines<R> {
    input: BufReader<R>,
    line: usize,
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(into)?;
        self.consume(read);
        Ok(read)
    }
}

impl<R: Read> BufRead for Lines<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.input.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.line += self.input.buffer()[..amount].iter().filter(|&&byte| byte == b'\n').count();
        self.input.consume(amount);
    }
}
