//! Policy numbers of the diagnosis: each decides something, and costs its next reader. They are listed and counted by room, and may
//! only become fewer.
//!
//!     cargo test -p system-tests --test numbers -- --nocapture      lists them

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Most numbers with a name, and most in the middle of code (guards against a division by zero and factors of formulas, mostly). Who
/// takes some away lowers these; nobody raises them.
const NAMED: usize = 118;
const BARE: usize = 274;

/// Whose numbers decide nothing: a file, or a constant in it, and what it is instead.
const OTHER: [(&str, &str, &str); 17] = [
    ("observe/measure.rs", "", "exponents of units of measurement"),
    ("statistics/random.rs", "", "a published generator"),
    ("report_graphs.rs", "", "how large a graph is"),
    ("planned.rs", "", "how large a graph is"),
    (
        "rigs/acrobot/candidates/list.rs",
        "",
        "what can be wrong, as data: bounds and scales of the units' own parameters",
    ),
    ("rigs/acrobot/experiment/catalogue.rs", "", "what a lab can do, as data"),
    ("design/waves.rs", "LEVELS", "what a lab can do, as data"),
    ("design/waves.rs", "SHAPES", "what a lab can do, as data"),
    ("check/units.rs", "FACTORS", "units of measurement"),
    ("observe/clock.rs", "", "what a format of time is"),
    ("rigs/acrobot/dataset/table.rs", "DAY", "seconds"),
    ("rigs/acrobot/dataset/stated_log.rs", "KEYS", "units of measurement"),
    ("rigs/acrobot/plausibility/motion.rs", "WAYS", "units of measurement"),
    ("rigs/acrobot/parameters.rs", "LINKS", "the paper's arm"),
    ("rigs/acrobot/residual_places.rs", "SHOWN", "an order of columns"),
    ("rigs/acrobot/selection/examples.rs", "", "compiled for tests only"),
    ("rigs/acrobot/check/examples.rs", "", "compiled for tests only"),
];

/// A number: where it stands, its name, and what it is.
struct Number {
    room: String,
    file: String,
    name: String,
    value: String,
}

/// Reads a file for its numbers.
#[derive(Default)]
struct Reader {
    named: Vec<(String, String)>,
    bare: Vec<String>,
}

fn tests_only(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|one| {
        one.path().is_ident("cfg")
            && matches!(&one.meta, syn::Meta::List(list) if list.tokens.to_string().contains("test"))
    })
}

/// What any reader takes for granted: none, one, a pair; in the middle of a formula a half, too.
fn plain(literal: &str) -> bool {
    let digits: String = literal.chars().take_while(|c| c.is_ascii_digit() || ".eE-_".contains(*c)).collect();
    digits.replace('_', "").parse().is_ok_and(|value: f64| [0.0, 1.0, 2.0].contains(&value))
}

/// Literals of an expression, without those that are plain. Signs are no part of them.
#[derive(Default)]
struct Literals(Vec<String>);

impl<'a> Visit<'a> for Literals {
    fn visit_lit(&mut self, literal: &'a syn::Lit) {
        let text = match literal {
            syn::Lit::Int(int) => int.to_string(),
            syn::Lit::Float(float) => float.to_string(),
            _ => return,
        };
        self.0.extend((!plain(&text)).then_some(text));
    }

    fn visit_expr_index(&mut self, index: &'a syn::ExprIndex) {
        self.visit_expr(&index.expr);
    }
}

fn literals(expression: &syn::Expr) -> Vec<String> {
    let mut found = Literals::default();
    found.visit_expr(expression);
    found.0
}

/// Fields of structs that stand anywhere in a constant.
#[derive(Default)]
struct Fields(Vec<(String, String)>);

impl<'a> Visit<'a> for Fields {
    fn visit_expr_struct(&mut self, all: &'a syn::ExprStruct) {
        for field in &all.fields {
            let found = literals(&field.expr);
            if let (syn::Member::Named(name), false) = (&field.member, found.is_empty()) {
                self.0.push((name.to_string(), found.join(", ")));
            }
        }
    }
}

impl Reader {
    fn constant(&mut self, name: &syn::Ident, value: &syn::Expr) {
        let mut fields = Fields::default();
        fields.visit_expr(value);
        if fields.0.is_empty() {
            let found = literals(value);
            self.named.extend((!found.is_empty()).then(|| (name.to_string(), found.join(", "))));
        } else {
            self.named.extend(fields.0.into_iter().map(|(field, value)| (format!("{name}.{field}"), value)));
        }
    }
}

impl<'a> Visit<'a> for Reader {
    fn visit_item(&mut self, item: &'a syn::Item) {
        let attributes = match item {
            syn::Item::Mod(item) => &item.attrs,
            syn::Item::Fn(item) => &item.attrs,
            syn::Item::Impl(item) => &item.attrs,
            _ => return visit::visit_item(self, item),
        };
        if !tests_only(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_const(&mut self, item: &'a syn::ItemConst) {
        self.constant(&item.ident, &item.expr);
    }

    fn visit_impl_item_const(&mut self, item: &'a syn::ImplItemConst) {
        self.constant(&item.ident, &item.expr);
    }

    fn visit_type(&mut self, _: &'a syn::Type) {}

    fn visit_expr_index(&mut self, index: &'a syn::ExprIndex) {
        self.visit_expr(&index.expr);
    }

    fn visit_lit(&mut self, literal: &'a syn::Lit) {
        let mut found = Literals::default();
        found.visit_lit(literal);
        self.bare.extend(found.0.into_iter().filter(|text| text != "0.5"));
    }
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("sources can be read") {
        let path = entry.expect("entries can be read").path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with("tests.rs") {
            into.push(path);
        }
    }
    into.sort();
}

/// Folder of a file, the rig's rooms each by itself.
fn room(file: &str) -> String {
    file.rsplit_once('/').map_or("(top)", |(folder, _)| folder).to_owned()
}

/// Named and bare numbers of the diagnosis.
fn numbers() -> (Vec<Number>, Vec<Number>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../diagnosis/src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let (mut named, mut bare) = (Vec::new(), Vec::new());
    for path in files {
        let file = path.strip_prefix(&root).expect("it lies there").to_string_lossy().into_owned();
        let other = |name: &str| OTHER.iter().any(|(there, what, _)| *there == file && *what == name);
        if other("") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("sources are text");
        let mut reader = Reader::default();
        reader.visit_file(&syn::parse_file(&text).unwrap_or_else(|error| panic!("{file}: {error}")));
        let number =
            |name: String, value: String| Number { room: room(&file), file: file.clone(), name, value };
        named.extend(
            reader
                .named
                .into_iter()
                .filter(|(name, _)| !other(name))
                .map(|(name, value)| number(name, value)),
        );
        bare.extend(reader.bare.into_iter().map(|value| number(String::new(), value)));
    }
    (named, bare)
}

fn by_room(all: &[Number]) -> BTreeMap<&str, usize> {
    let mut rooms = BTreeMap::new();
    all.iter().for_each(|number| *rooms.entry(number.room.as_str()).or_default() += 1);
    rooms
}

#[test]
fn policy_numbers_of_the_diagnosis_only_become_fewer() {
    let (named, bare) = numbers();
    for number in &named {
        println!("{}: {} = {}", number.file, number.name, number.value);
    }
    for number in &bare {
        println!("{}: {}", number.file, number.value);
    }
    let (rooms, bare_rooms) = (by_room(&named), by_room(&bare));
    let all: std::collections::BTreeSet<_> = rooms.keys().chain(bare_rooms.keys()).collect();
    for room in all {
        println!(
            "{:4} named {:4} bare  {room}",
            rooms.get(*room).unwrap_or(&0),
            bare_rooms.get(*room).unwrap_or(&0)
        );
    }
    println!("{:4} named {:4} bare  in all", named.len(), bare.len());
    assert!(named.len() > 20, "what finds them finds nothing any more");
    assert!(
        named.len() <= NAMED,
        "{} numbers with a name, {NAMED} are allowed: what would do without a new one?",
        named.len()
    );
    assert!(
        bare.len() <= BARE,
        "{} numbers in the middle of code, {BARE} are allowed: what would do without a new one?",
        bare.len()
    );
}
