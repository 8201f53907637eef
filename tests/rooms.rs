//! The rooms of the diagnosis use each other as ARCHITECTURE.md says, and in no circle that it doesn't admit.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// The heading over the table.
const HEADING: &str = "## Rooms of the diagnosis";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default()
}

/// A row of the table: a room, those above it that it uses, and those below it.
struct Row {
    room: String,
    uses: BTreeSet<String>,
    against: BTreeSet<String>,
}

/// The table of the page.
fn table(page: &str) -> Vec<Row> {
    let part = page.split(HEADING).nth(1).and_then(|rest| rest.split("\n## ").next()).unwrap_or_default();
    let names = |cell: Option<&str>| -> BTreeSet<String> {
        cell.unwrap_or_default().split('`').skip(1).step_by(2).map(str::to_owned).collect()
    };
    let row = |line: &str| {
        let mut cells = line.strip_prefix("| `")?.split('|');
        let room = cells.next()?.split('`').next()?.to_owned();
        Some(Row { room, uses: names(cells.next()), against: names(cells.next()) })
    };
    part.lines().filter_map(row).collect()
}

/// First names of all `crate::` paths of a file that are compiled into the product.
#[derive(Default)]
struct Paths {
    found: BTreeSet<String>,
    /// Modules in files of their own that only tests have.
    tests: Vec<String>,
}

fn for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|one| {
        one.path().is_ident("cfg")
            && matches!(&one.meta, syn::Meta::List(list) if list.tokens.to_string() == "test")
    })
}

/// First names of a tree of uses.
fn first(tree: &syn::UseTree, found: &mut BTreeSet<String>) {
    match tree {
        syn::UseTree::Path(path) => drop(found.insert(path.ident.to_string())),
        syn::UseTree::Name(name) => drop(found.insert(name.ident.to_string())),
        syn::UseTree::Rename(name) => drop(found.insert(name.ident.to_string())),
        syn::UseTree::Group(group) => group.items.iter().for_each(|tree| first(tree, found)),
        syn::UseTree::Glob(_) => drop(found.insert("*".to_owned())),
    }
}

impl<'a> Visit<'a> for Paths {
    fn visit_item(&mut self, item: &'a syn::Item) {
        let attributes = match item {
            syn::Item::Mod(item) => &item.attrs,
            syn::Item::Fn(item) => &item.attrs,
            syn::Item::Impl(item) => &item.attrs,
            syn::Item::Use(item) => &item.attrs,
            _ => return visit::visit_item(self, item),
        };
        match item {
            syn::Item::Mod(item) if for_tests(attributes) => self.tests.push(item.ident.to_string()),
            _ if for_tests(attributes) => {}
            _ => visit::visit_item(self, item),
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'a syn::ImplItemFn) {
        if !for_tests(&function.attrs) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_use_path(&mut self, path: &'a syn::UsePath) {
        if path.ident == "crate" {
            first(&path.tree, &mut self.found);
        }
        visit::visit_use_path(self, path);
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let mut names = path.segments.iter().map(|segment| segment.ident.to_string());
        if names.next().is_some_and(|name| name == "crate") {
            self.found.extend(names.next());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'a syn::Macro) {
        let text: String = call.tokens.to_string().split_whitespace().collect();
        let name =
            |rest: &str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().map(str::to_owned);
        self.found.extend(text.split("crate::").skip(1).filter_map(name));
        visit::visit_macro(self, call);
    }
}

/// All sources below a folder, without those that only tests have.
fn sources(folder: &Path, all: &mut BTreeMap<PathBuf, Paths>) {
    for entry in std::fs::read_dir(folder).expect("folders of the repository can be read") {
        let path = entry.expect("entries can be read").path();
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = std::fs::read_to_string(&path).expect("source files are text");
            let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let mut paths = Paths::default();
            paths.visit_file(&file);
            all.insert(path, paths);
        }
    }
}

/// Which rooms each room uses.
fn used() -> BTreeMap<String, BTreeSet<String>> {
    let folder = root().join("diagnosis/src");
    let mut all = BTreeMap::new();
    sources(&folder, &mut all);
    let modules = |path: &Path| match path.file_stem().and_then(|name| name.to_str()) {
        Some("mod" | "lib") | None => path.parent().unwrap_or(Path::new("")).to_path_buf(),
        Some(stem) => path.with_file_name(stem),
    };
    let tests: BTreeSet<PathBuf> = (all.iter())
        .flat_map(|(path, paths)| paths.tests.iter().map(move |name| (path, name)))
        .map(|(path, name)| modules(path).join(name))
        .collect();
    let mut rooms: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, paths) in
        all.iter().filter(|(path, _)| !tests.iter().any(|test| path.with_extension("").starts_with(test)))
    {
        let inside = path.strip_prefix(&folder).expect("it lies there").with_extension("");
        let room = inside.iter().next().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        // the face of the crate
        if room != "lib" {
            let others = paths.found.iter().filter(|name| **name != room).cloned();
            rooms.entry(room.clone()).or_default().extend(others);
        }
    }
    rooms
}

#[test]
fn every_room_of_the_diagnosis_uses_those_that_the_map_says() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("it is at the root");
    let (table, used) = (table(&page), used());
    assert!(used.len() > 15, "{} rooms", used.len());
    let mut above = BTreeSet::new();
    for Row { room, uses, against } in &table {
        let known: BTreeSet<String> = uses.union(against).cloned().collect();
        let found = used
            .get(room)
            .unwrap_or_else(|| panic!("ARCHITECTURE.md names the room `{room}`, which is none"));
        let new: Vec<&String> = found.difference(&known).collect();
        let gone: Vec<&String> = known.difference(found).collect();
        assert!(new.is_empty(), "`{room}` uses {new:?}, which its row of ARCHITECTURE.md doesn't have");
        assert!(
            gone.is_empty(),
            "`{room}` no longer uses {gone:?}: take it out of its row of ARCHITECTURE.md"
        );
        let below: Vec<&String> = uses.difference(&above).collect();
        assert!(below.is_empty(), "`{room}` uses {below:?}, of which no row stands above its own: a circle");
        let needless: Vec<&String> = against.intersection(&above).collect();
        assert!(needless.is_empty(), "`{room}` uses {needless:?} along the order");
        above.insert(room.clone());
    }
    let missing: Vec<&String> = used.keys().filter(|room| !above.contains(*room)).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md has no row for {missing:?}");
}

#[test]
fn every_way_to_name_a_room_is_seen() {
    let text = "use crate::{one, two::x}; use crate::three as y; fn f() -> crate::four::T { assert!(crate::five::g()); } \
                #[cfg(test)] use crate::six; #[cfg(test)] mod tests { use crate::seven; } pub(crate) struct S;";
    let mut paths = Paths::default();
    paths.visit_file(&syn::parse_file(text).expect("it is Rust"));
    assert_eq!(Vec::from_iter(&paths.found), ["five", "four", "one", "three", "two"]);
}
