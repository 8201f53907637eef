//! Where a document says that another file lies: a relative URI that stays within the package.

use super::document::Document;
use crate::Error;
use orchestrator::xml::Element;

/// The name in the package of a file that `element` gives by `source`, relative to the document called `base`.
pub(super) fn resolve(
    document: &Document,
    element: &Element,
    base: &str,
    uri: &str,
) -> Result<String, Error> {
    let wrong =
        |expected: &str| document.wrong(element, format!("source=\"{uri}\" of <{}>", element.name), expected);
    let scheme = uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b))
    });
    if scheme || uri.starts_with(['/', '\\']) {
        return Err(wrong(
            "a file inside the package, such as resources/unit.fmu; nothing outside is opened",
        ));
    }
    if uri.contains('#') {
        return Err(wrong("a whole file; parts of documents can't be referred to"));
    }
    let path = decode(uri).ok_or_else(|| wrong("a URI, in which % is followed by two hexadecimal digits"))?;
    let folder = base.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop().ok_or_else(|| {
                    wrong(
                        "a file inside the package; this one leads out of it, and nothing outside is opened",
                    )
                })?;
            }
            part => parts.push(part),
        }
    }
    if parts.is_empty() {
        return Err(wrong("the name of a file"));
    }
    Ok(parts.join("/"))
}

fn decode(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let mut digit = || (rest.next()? as char).to_digit(16);
        let (high, low) = (digit()?, digit()?);
        bytes.push(u8::try_from(high * 16 + low).ok()?);
    }
    String::from_utf8(bytes).ok().filter(|path| !path.contains('\0'))
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn value_percent_codes_are_read() {
        assert_eq!(decode("a%20b.fmu").as_deref(), Some("a b.fmu"));
        assert_eq!(decode("a%23b.fmu").as_deref(), Some("a#b.fmu"));
        for wrong in ["a%2", "a%zz", "%ff", "a%00b"] {
            assert_eq!(decode(wrong), None, "{wrong}");
        }
    }
}
