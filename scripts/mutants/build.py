"""A copy of the repository in which a crate holds all its changes at once, and its tests, built once."""

import hashlib
import json
import os
import shutil
import subprocess
from pathlib import Path

import changes

SWITCH = '''
/// Which of the changes is on: scripts/mutants.
#[doc(hidden)]
#[allow(missing_docs, clippy::all)]
mod mutant_switch {
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};

    static ON: OnceLock<usize> = OnceLock::new();
    static SEEN: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];

    pub fn is(number: usize) -> bool {
        let on = *ON.get_or_init(|| std::env::var("MUTANT").map_or(0, |text| text.parse().unwrap_or(0)));
        if on == 0 && !SEEN[number].load(Ordering::Relaxed) {
            see(number);
        }
        on == number
    }

    #[cold]
    fn see(number: usize) {
        SEEN[number].store(true, Ordering::Relaxed);
        let Ok(path) = std::env::var("MUTANTS_SEEN") else { return };
        let file = std::fs::File::options().append(true).create(true).open(path);
        let _ = file.and_then(|mut file| std::io::Write::write_all(&mut file, format!("{number}\\n").as_bytes()));
    }
}
'''


class Crate:
    """A crate in a copy of the repository."""

    def __init__(self, root, folder, copy, target):
        self.root, self.folder, self.copy = root, folder, copy
        self.environment = os.environ | {"CARGO_TARGET_DIR": str(target), "CARGO_INCREMENTAL": "0"}
        self.sources = {}

    def duplicate(self):
        """The copy: files that git knows or does not ignore. All are new, since cargo takes a crate by its place in the
        workspace and the age of its files: else it would go on with another copy's."""
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=self.root, capture_output=True, check=True
        ).stdout.decode()
        shutil.rmtree(self.copy, ignore_errors=True)
        for name in filter(None, listed.split("\0")):
            if (self.root / name).is_file():
                (self.copy / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(self.root / name, self.copy / name)

    def changes(self):
        """All changes that are tried, numbered from 1."""
        found = []
        for path in sorted((self.copy / self.folder / "src").rglob("*.rs")):
            if path.name in ("tests.rs", "main.rs") or "bin" in path.parts:
                continue
            name = str(path.relative_to(self.copy))
            self.sources[name] = path.read_bytes()
            found += changes.of(name, self.sources[name])
        for number, change in enumerate(found, 1):
            change.number = number
        return found

    def write(self, kept, count):
        """Puts these changes into the copy."""
        for name, source in self.sources.items():
            here = [change for change in kept if change.file == name]
            text = changes.behind_switches(source, here)
            if name.endswith("src/lib.rs"):
                text += SWITCH.replace("COUNT", str(count + 1)).encode()
            (self.copy / name).write_bytes(text)

    def build(self, found):
        """Builds the tests without the changes that are no Rust; answers with those left, and the test programs."""
        # Which ones those are is kept for as long as the sources stay: a second run is mostly one with more tests.
        text = b"".join(self.sources[name] for name in sorted(self.sources))
        known = self.copy.with_name(f"{self.copy.name}-{hashlib.sha256(text).hexdigest()[:16]}.json")
        left_out = set(json.loads(known.read_text())) if known.is_file() else set()
        kept = [change for change in found if str(change) not in left_out]
        for _ in range(12):
            self.write(kept, len(found))
            done = subprocess.run(
                ["cargo", "test", "--release", "--no-run", "--lib", "--tests", "--message-format", "json", "--quiet"],
                cwd=self.copy / self.folder, env=self.environment, capture_output=True, text=True,
            )  # fmt: skip
            messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
            if done.returncode == 0:
                programs = [m["executable"] for m in messages if m.get("profile", {}).get("test") and m.get("executable")]
                return kept, list(dict.fromkeys(programs))
            wrong = refused(messages, kept, self.copy)
            if not wrong:
                raise SystemExit(f"{self.folder}: does not build:\n{done.stderr[-4000:]}")
            left_out |= {str(change) for change in kept if change.number in wrong}
            known.write_text(json.dumps(sorted(left_out)))
            kept = [change for change in kept if change.number not in wrong]
        raise SystemExit(f"{self.folder}: does not build, whatever is left out")


def refused(messages, kept, copy):
    """The changes that errors of the compiler point at, by the switch on the same lines, else by the nearest above."""
    wrong = set()
    texts = {}
    known = {change.number for change in kept}
    for message in messages:
        if message.get("reason") != "compiler-message" or message["message"]["level"] != "error":
            continue
        for span in message["message"]["spans"]:
            if not span["is_primary"]:
                continue
            path = copy / span["file_name"]
            if not path.is_file():
                continue
            text = texts.setdefault(path, path.read_bytes())
            wrong |= around(text, span["byte_start"], span["byte_end"]) & known
    return wrong


def around(text, start, end):
    """Numbers of the switch whose changed branch holds this place; else of all on its lines."""
    opening = f"if {changes.SWITCH}(".encode()
    at = text.rfind(opening, 0, end)
    while at >= 0 and at > start - 4000:
        number = int(text[at + len(opening) : text.index(b")", at)])
        brace = text.index(b"{", at)
        depth, close = 0, brace
        while close < len(text):
            depth += {b"{": 1, b"}": -1}.get(text[close : close + 1], 0)
            if depth == 0:
                break
            close += 1
        if brace < start <= close:
            return {number}
        at = text.rfind(opening, 0, at)
    first = text.rfind(b"\n", 0, start)
    last = text.find(b"\n", end)
    numbers = set()
    for piece in text[first:last].split(opening)[1:]:
        numbers.add(int(piece[: piece.index(b")")]))
    return numbers
