//! The map is true: crates depend on each other only along the arrows of ARCHITECTURE.md, every path it names
//! exists, and every third-party crate has its line of reason.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default()
}

fn metadata() -> Metadata {
    MetadataCommand::new().current_dir(root()).no_deps().exec().expect("cargo metadata answers")
}

/// The only arrows, as the block of ARCHITECTURE.md has them: crates, and those that they may depend on. Lines that begin with blanks go on.
fn arrows(page: &str) -> Vec<(Vec<String>, Vec<String>)> {
    let block = page.split("## Arrows").nth(1).and_then(|rest| rest.split("```").nth(1)).unwrap_or_default();
    let names = |text: &str, separator: char| -> Vec<String> {
        let each = text.split(separator).map(|name| name.split('(').next().unwrap_or_default().trim());
        each.filter(|name| !name.is_empty()).map(str::to_owned).collect()
    };
    let mut all: Vec<(Vec<String>, Vec<String>)> = Vec::new();
    for line in block.lines() {
        match (line.split_once('→'), all.last_mut()) {
            (Some((from, to)), _) => {
                let from = from.replace(',', " ");
                all.push((names(&from, ' '), names(to, ',')));
            }
            (None, Some((_, to))) => to.extend(names(line, ',')),
            (None, None) => {}
        }
    }
    all
}

/// What a crate may depend on. Shells (`*-fmu`) depend on their own model and on the export; nobody depends on a shell, nor do tests ship.
fn arrows_of(name: &str, arrows: &[(Vec<String>, Vec<String>)]) -> Vec<String> {
    if let Some(model) = name.strip_suffix("-fmu") {
        return vec![model.to_owned(), "fmi2-export".to_owned()];
    }
    if name == "system-tests" {
        return Vec::new();
    }
    let known = arrows.iter().find(|(from, _)| from.iter().any(|own| own == name));
    known
        .unwrap_or_else(|| panic!("crate `{name}` has no line among the arrows of ARCHITECTURE.md"))
        .1
        .clone()
}

/// The name that the map uses: the registry's one of the master is longer.
fn short(package: &str) -> &str {
    if package == "acroscope-orchestrator" { "orchestrator" } else { package }
}

#[test]
fn every_dependency_follows_an_arrow() {
    let page =
        std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is at the root");
    let (metadata, arrows) = (metadata(), arrows(&page));
    let ours: BTreeSet<&str> = metadata.packages.iter().map(|package| package.name.as_str()).collect();
    for package in &metadata.packages {
        let allowed = arrows_of(short(&package.name), &arrows);
        let product =
            package.dependencies.iter().filter(|dependency| dependency.kind != DependencyKind::Development);
        for dependency in product.filter(|dependency| ours.contains(dependency.name.as_str())) {
            assert!(
                allowed.iter().any(|name| name == short(&dependency.name)),
                "{} -> {} is no arrow of ARCHITECTURE.md",
                package.name,
                dependency.name
            );
        }
    }
}

#[test]
fn every_path_in_the_map_exists() {
    let text =
        std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is at the root");
    let paths: Vec<&str> = text
        .split('`')
        .skip(1)
        .step_by(2)
        .filter(|code| code.contains('/') && !code.contains([' ', '*', '<', ':']))
        .collect();
    assert!(paths.len() > 20, "the map names {} paths", paths.len());
    let made = ["target/", "out/"]; // by the build, not committed
    for path in paths.iter().filter(|path| !made.iter().any(|folder| path.starts_with(folder))) {
        assert!(root().join(path).exists(), "ARCHITECTURE.md names `{path}`, which does not exist");
    }
}

#[test]
fn every_third_party_crate_has_its_reason() {
    let text =
        std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is at the root");
    let metadata = metadata();
    let ours: BTreeSet<&str> = metadata.packages.iter().map(|package| package.name.as_str()).collect();
    let theirs: BTreeSet<&str> = (metadata.packages.iter())
        .flat_map(|package| &package.dependencies)
        .map(|dependency| dependency.name.as_str())
        .filter(|name| !ours.contains(name))
        .collect();
    for name in theirs {
        assert!(
            text.contains(&format!("| `{name}` |")),
            "ARCHITECTURE.md has no line for the crate `{name}`"
        );
    }
}

/// What `cargo deny check licenses` asks, where there is no `cargo deny`: the licence of every crate that is built into anything
/// can be met with those that `deny.toml` allows.
#[test]
fn every_licence_is_among_those_allowed() {
    let text = std::fs::read_to_string(root().join("deny.toml")).expect("deny.toml is at the root");
    let deny: toml::Table = text.parse().expect("deny.toml is TOML");
    let allowed: Vec<&str> = (deny["licenses"]["allow"].as_array().expect("a list"))
        .iter()
        .map(|name| name.as_str().expect("a name"))
        .collect();
    assert!(!met("MIT AND GPL-3.0-only", &allowed) && !met("(GPL-2.0 OR LGPL-2.1) AND MIT", &allowed));
    assert!(met("GPL-3.0-only OR (MIT AND Zlib)", &allowed) && met("GPL-2.0/MIT", &allowed));
    let locked = vec!["--locked".to_owned()];
    let all = MetadataCommand::new().current_dir(root()).other_options(locked).exec().expect("metadata");
    assert!(all.packages.len() > 100, "{} crates", all.packages.len());
    for package in &all.packages {
        let licence = package.license.as_deref().unwrap_or("none");
        let name = &package.name;
        assert!(met(licence, &allowed), "{name}: licence {licence}; deny.toml allows {allowed:?}");
    }
}

/// Whether an SPDX expression can be met with these licences. `AND` binds closer than `OR`; old crates write `/` for `OR`.
fn met(expression: &str, allowed: &[&str]) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    return any(&mut words, allowed);

    type Words<'a> = std::iter::Peekable<std::str::SplitWhitespace<'a>>;

    fn any(words: &mut Words<'_>, allowed: &[&str]) -> bool {
        let mut met = all(words, allowed);
        while words.next_if_eq(&"OR").is_some() {
            met |= all(words, allowed);
        }
        met
    }

    fn all(words: &mut Words<'_>, allowed: &[&str]) -> bool {
        let mut met = one(words, allowed);
        while words.next_if_eq(&"AND").is_some() {
            met &= one(words, allowed);
        }
        met
    }

    fn one(words: &mut Words<'_>, allowed: &[&str]) -> bool {
        let mut name = words.next().unwrap_or_default().to_owned();
        if name == "(" {
            let met = any(words, allowed);
            assert_eq!(words.next(), Some(")"), "a licence with a bracket that does not end");
            return met;
        }
        if words.next_if_eq(&"WITH").is_some() {
            name += " WITH ";
            name += words.next().unwrap_or_default();
        }
        allowed.contains(&name.as_str())
    }
}

#[test]
fn every_source_file_says_what_it_is() {
    let mut folders = vec![root()];
    let mut seen = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("folders of the repository can be read") {
            let path = entry.expect("entries can be read").path();
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
            if path.is_dir() {
                if !name.starts_with('.') && name != "target" && name != "out" {
                    folders.push(path);
                }
            } else if name.ends_with(".rs") {
                seen += 1;
                let text = std::fs::read_to_string(&path).expect("source files are text");
                assert!(text.starts_with("//!"), "{} does not begin with //!", path.display());
            }
        }
    }
    assert!(seen > 50, "found {seen} source files");
}

#[test]
fn every_text_can_be_followed_by_who_has_only_the_clone() {
    // Papers of the workplace that no clone has. Written apart, so that this list doesn't find itself.
    let papers =
        [("CONT", "RACT"), ("HOU", "SE"), ("TARG", "ETS"), ("PE", "ERS")].map(|(a, b)| format!("{a}{b}"));
    let places = [("../sha", "red"), ("work/sha", "red")].map(|(a, b)| format!("{a}{b}"));
    let texts = ["rs", "md", "toml", "py", "sh", "xml", "txt", "c", "js", "css", "html"];
    let mut seen = 0;
    every_file(&root(), &mut |path, name| {
        let is_text = path.extension().is_some_and(|ending| texts.iter().any(|text| ending == *text));
        if !is_text || name.starts_with("LICENSE") {
            return;
        }
        seen += 1;
        let text = std::fs::read_to_string(path).unwrap_or_default();
        for (number, line) in text.lines().enumerate() {
            let words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
            let cited = words.filter(|word| papers.iter().any(|paper| paper == word)).count() > 0;
            let cited = cited || places.iter().any(|place| line.contains(place.as_str()));
            assert!(
                !cited,
                "{}:{} cites what a clone lacks; docs/ has it: {line}",
                path.display(),
                number + 1
            );
        }
    });
    assert!(seen > 200, "found {seen} texts");
}

#[test]
fn every_link_of_a_page_leads_somewhere() {
    let mut seen = 0;
    every_file(&root(), &mut |path, name| {
        if !name.ends_with(".md") {
            return;
        }
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
        for target in targets.filter(|target| !target.is_empty() && !target.contains("://")) {
            seen += 1;
            let folder = path.parent().unwrap_or(Path::new(""));
            assert!(
                folder.join(target).exists(),
                "{} links to {target}, which does not exist",
                path.display()
            );
        }
    });
    assert!(seen > 10, "found {seen} links");
}

#[test]
fn every_file_of_a_crates_tests_is_run() {
    // one program runs all tests of a crate, since each takes seconds to link; a file that it doesn't name would be left out in silence
    let mut named = 0;
    for package in metadata().packages {
        let folder = package.manifest_path.parent().expect("a manifest lies in a folder").join("tests");
        let of_its_own =
            |file: &Path| package.targets.iter().any(|target| target.src_path.as_std_path() == file);
        let all = std::fs::read_to_string(folder.join("all.rs")).unwrap_or_default();
        for entry in std::fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.expect("entries can be read").path();
            let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
            let is_named = all.lines().any(|line| line == format!("mod {stem};"));
            let is_test = path.extension().is_some_and(|ending| ending == "rs");
            assert!(
                !is_test || is_named || of_its_own(&path),
                "no line of tests/all.rs names {}",
                path.display()
            );
            named += usize::from(is_test && is_named);
        }
    }
    assert!(named > 90, "found {named} files");
}

/// Calls for each file of the repository that is not made by a build.
fn every_file(folder: &Path, each: &mut dyn FnMut(&Path, &str)) {
    let made = ["target", "out", "node_modules", "__pycache__"];
    for entry in std::fs::read_dir(folder).expect("folders of the repository can be read") {
        let path = entry.expect("entries can be read").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        if path.is_dir() {
            // `.venv` and `.git` are no part of the clone.
            if !made.contains(&name.as_str()) && (!name.starts_with('.') || name == ".ci" || name == ".cargo")
            {
                every_file(&path, each);
            }
        } else {
            each(&path, &name);
        }
    }
}
