"""A copy of the repository in which the diagnosis holds all its switches at once, built once."""

import importlib.util
import json
import subprocess
from pathlib import Path

import points

# The copy and its build are those of scripts/mutants, whose file has this one's name.
_spec = importlib.util.spec_from_file_location("mutants_build", Path(__file__).resolve().parents[1] / "mutants" / "build.py")
_mutants = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(_mutants)

SWITCH = '''
/// What is switched off or moved: scripts/ablate.
#[doc(hidden)]
#[allow(missing_docs, clippy::all)]
pub mod ablation {
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicU8, Ordering};

    static SEEN: [AtomicU8; COUNT] = [const { AtomicU8::new(0) }; COUNT];
    static SET: OnceLock<Vec<(u8, f64)>> = OnceLock::new();

    /// `ABLATE`: `12+` holds condition 12, `12-` denies it, `13*2` doubles number 13; commas between.
    fn set(place: usize) -> (u8, f64) {
        SET.get_or_init(|| {
            let mut all = vec![(0, 1.0); COUNT];
            let text = std::env::var("ABLATE").unwrap_or_default();
            for word in text.split(',').filter(|word| !word.is_empty()) {
                let at = word.find(['+', '-', '*']).expect("a word of ABLATE");
                let place: usize = word[..at].parse().expect("a number of a point");
                match &word[at..at + 1] {
                    "+" => all[place].0 = 1,
                    "-" => all[place].0 = 2,
                    _ => all[place].1 = word[at + 1..].parse().expect("a factor"),
                }
            }
            all
        })[place]
    }

    pub fn is(place: usize, holds: bool) -> bool {
        see(place, if holds { 1 } else { 2 });
        match set(place).0 {
            0 => holds,
            forced => forced == 1,
        }
    }

    pub fn number<T: Number>(place: usize, value: T) -> T {
        see(place, 1);
        let factor = set(place).1;
        if factor == 1.0 { value } else { value.times(factor) }
    }

    fn see(place: usize, bit: u8) {
        if SEEN[place].load(Ordering::Relaxed) & bit == 0 {
            first(place, bit);
        }
    }

    #[cold]
    fn first(place: usize, bit: u8) {
        if SEEN[place].fetch_or(bit, Ordering::Relaxed) & bit != 0 {
            return;
        }
        let Ok(path) = std::env::var("ABLATE_SEEN") else { return };
        let file = std::fs::File::options().append(true).create(true).open(path);
        let _ = file.and_then(|mut file| std::io::Write::write_all(&mut file, format!("{place} {bit}\\n").as_bytes()));
    }

    pub trait Number: Copy {
        fn times(self, factor: f64) -> Self;
    }
    macro_rules! whole {
        ($($kind:ty)*) => { $(impl Number for $kind {
            fn times(self, factor: f64) -> Self { (self as f64 * factor).round() as $kind }
        })* };
    }
    impl Number for f64 {
        fn times(self, factor: f64) -> Self { self * factor }
    }
    whole!(u8 u16 u32 u64 i32 i64 usize);
}
'''

JUDGE = '''//! One data set, diagnosed: scripts/ablate.
fn main() {
    let words: Vec<String> = std::env::args().collect();
    let units = scenarios::unit_path().with(&words[1]);
    let mut options = diagnosis::Options::default();
    options.without = words[3..].to_vec();
    match diagnosis::diagnose(words[2].as_ref(), &units, &options, &mut |_| {}) {
        Ok(found) => println!("{}", found.to_json()),
        Err(error) => println!("{{\\"error\\": {:?}}}", error.to_string()),
    }
}
'''


class Ablated(_mutants.Crate):
    """The diagnosis in a copy of the repository."""

    def __init__(self, root, copy, target):
        super().__init__(root, "diagnosis", copy, target)
        self.environment["CARGO_INCREMENTAL"] = "1"

    def points(self):
        for path in sorted((self.copy / self.folder / "src").rglob("*.rs")):
            if path.name != "tests.rs":
                self.sources[str(path.relative_to(self.copy))] = path.read_bytes()
        return points.of(self.sources)

    def write(self, kept, count):
        for name, source in self.sources.items():
            text = points.instrumented(name, source, kept)
            if name.endswith("diagnosis/src/lib.rs"):
                text += SWITCH.replace("COUNT", str(count + 1)).encode()
            if not (self.copy / name).exists() or (self.copy / name).read_bytes() != text:
                (self.copy / name).write_bytes(text)
        (self.copy / self.folder / "examples").mkdir(exist_ok=True)
        (self.copy / self.folder / "examples" / "judge.rs").write_text(JUDGE)

    def build(self, found, tests=True):
        """Builds the judge, and the tests if they are wanted, without the points that are no Rust; answers with those left, and the programs."""
        kept = found
        what = ["test", "--no-run", "--lib", "--tests"] if tests else ["build"]
        for _ in range(12):
            self.write(kept, len(found))
            done = subprocess.run(
                ["cargo", *what, "--release", "--examples", "--message-format", "json", "--quiet"],
                cwd=self.copy / self.folder, env=self.environment, capture_output=True, text=True,
            )  # fmt: skip
            messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
            if done.returncode == 0:
                made = [(m["target"]["name"], m["executable"]) for m in messages if m.get("executable")]
                return kept, next(path for name, path in made if name == "judge"), [path for name, path in made if name != "judge"]
            # the switches add no lines: an error's line is the point's own
            lines = set()
            for message in messages:
                if message.get("reason") == "compiler-message" and message["message"]["level"] == "error":
                    for span in message["message"]["spans"]:
                        name = next((n for n in self.sources if n.endswith(span["file_name"])), None)
                        lines |= {(name, line) for line in range(span["line_start"], span["line_end"] + 1)} if span["is_primary"] else set()
            wrong = {p.number for p in kept for file, _, _, line in p.uses if (file, line) in lines}
            if not wrong:
                raise SystemExit(f"does not build:\n{done.stderr[-4000:]}")
            print(f"  {len(wrong)} points are no Rust and are left out", flush=True)
            kept = [point for point in kept if point.number not in wrong]
        raise SystemExit("does not build, whatever is left out")
