//! Makes drawn SVG short: dots of one look become one path, and so do the strokes of a dashed line. plotters writes an element
//! for each, which is most of a page's bytes.

/// Points of a line that is no stroke of a dashed one.
const LONG: usize = 20;

/// The same picture with fewer elements.
pub(crate) fn compact(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len() / 2);
    let mut group: Option<Group> = None;
    for line in svg.lines() {
        match Piece::of(line) {
            Some(piece) => {
                if group.as_ref().is_none_or(|group| group.look != piece.look) {
                    flush(&mut out, group.take());
                    group = Some(Group {
                        look: piece.look,
                        whole: line.to_owned(),
                        path: String::new(),
                        count: 0,
                    });
                }
                if let Some(group) = &mut group {
                    group.path.push_str(&piece.path);
                    group.count += 1;
                }
            }
            None => {
                flush(&mut out, group.take());
                out.push_str(line);
                out.push('\n');
            }
        }
    }
    flush(&mut out, group);
    out.truncate(out.trim_end().len());
    out
}

/// Neighbours of one look.
struct Group {
    /// Attributes of the path that stands for all.
    look: String,
    /// The first one as it was, for one that has no like.
    whole: String,
    path: String,
    count: usize,
}

fn flush(out: &mut String, group: Option<Group>) {
    let Some(Group { look, whole, path, count }) = group else { return };
    match count {
        1 => out.push_str(&whole),
        _ => out.push_str(&format!("<path d=\"{path}\" {look}/>")),
    }
    out.push('\n');
}

/// One element as a part of a path.
struct Piece {
    look: String,
    path: String,
}

impl Piece {
    fn of(line: &str) -> Option<Self> {
        if let Some(rest) = line.strip_prefix("<circle ") {
            let [x, y, r, opacity, fill] =
                ["cx", "cy", "r", "opacity", "fill"].map(|name| attribute(rest, name));
            // A stroke of no length with round ends is a dot.
            let wide = 2.0 * r?.parse::<f64>().ok()?;
            let fill = fill.filter(|fill| *fill != "none")?;
            let look = format!(
                "fill=\"none\" opacity=\"{}\" stroke=\"{fill}\" stroke-width=\"{wide}\" stroke-linecap=\"round\"",
                opacity?
            );
            return Some(Self { look, path: format!("M{} {}h0", x?, y?) });
        }
        let rest = line.strip_prefix("<polyline ")?;
        let (look, points) = rest.strip_suffix("/>")?.split_once(" points=\"")?;
        // A long line stays what it is: an element of its own costs it nothing.
        if points.split_whitespace().count() > LONG {
            return None;
        }
        let mut path = String::new();
        for (place, point) in points.trim_end_matches('"').split_whitespace().enumerate() {
            path.push(if place == 0 { 'M' } else { 'L' });
            path.push_str(&point.replace(',', " "));
        }
        Some(Self { look: look.to_owned(), path })
    }
}

/// The value of an attribute.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let at = element.find(&format!("{name}=\""))?;
    let before = element[..at].chars().next_back();
    if before.is_some_and(|c| c != ' ') {
        return None;
    }
    element[at + name.len() + 2..].split('"').next()
}

#[cfg(test)]
mod tests {
    use super::compact;
    use crate::{Axis, Graph, Line};

    #[test]
    fn value_dots_and_dashes_of_one_look_are_one_path() {
        let dot = |x: u32| {
            format!(
                "<circle cx=\"{x}\" cy=\"7\" r=\"2\" opacity=\"1\" fill=\"#000000\" stroke=\"none\" stroke-width=\"1\"/>\n"
            )
        };
        let dash = |x: u32| {
            format!(
                "<polyline fill=\"none\" opacity=\"1\" stroke=\"#D55E00\" stroke-width=\"1\" points=\"{x},1 {x},2 \"/>\n"
            )
        };
        let svg =
            format!("<svg>\n{}{}<text>a</text>\n{}{}{}</svg>\n", dot(1), dot(2), dash(3), dash(4), dot(5));
        let expected = "<svg>\n<path d=\"M1 7h0M2 7h0\" fill=\"none\" opacity=\"1\" stroke=\"#000000\" stroke-width=\"4\" stroke-linecap=\"round\"/>\n<text>a</text>\n\
            <path d=\"M3 1L3 2M4 1L4 2\" fill=\"none\" opacity=\"1\" stroke=\"#D55E00\" stroke-width=\"1\"/>\n<circle cx=\"5\" cy=\"7\" r=\"2\" opacity=\"1\" fill=\"#000000\" stroke=\"none\" stroke-width=\"1\"/>\n</svg>";
        assert_eq!(compact(&svg), expected);
    }

    #[test]
    fn law_a_thousand_dots_cost_a_dozen_bytes_each() {
        // What plotters writes, not what this file believes that it writes.
        let points =
            |phase: f64| (0..1000).map(|i| (f64::from(i), (0.1 * f64::from(i) + phase).sin())).collect();
        let graph = Graph::new("t", Axis::fitted("x"), Axis::fitted("y"))
            .with(Line::dots("dots", points(0.0)))
            .with(Line::dashed("dashes", points(1.0)));
        let svg = graph.to_svg().expect("drawn");
        let elements = svg.matches("<circle").count() + svg.matches("<polyline").count();
        // An element for each is 110 bytes and more: over 200 000 for all.
        assert!(svg.len() < 60_000 && elements < 60, "{} bytes, {elements} elements", svg.len());
        assert_eq!(svg.matches("h0").count(), 1000);
    }
}
