"""Which conditions and numbers of the diagnosis change an answer: each is switched off or moved, and meets sets and tests.

    python scripts/ablate reach                    builds once; every judge once: what it reaches, and which way conditions went there
    python scripts/ablate list --file selection    what was found to stand where, with what reached it
    python scripts/ablate try '12-' '13*0,14-'     each of these (together where commas join them) against the judges that reach it
    python scripts/ablate all --file selection     both sides of every condition, every number times 0.25 and 4

Judges are the sets of scripts/blind.py (out/blind/sets, made by a run of that script), those given by --sets, and the tests of the
diagnosis. A set judges by verdict, names and members of classes; by values where they move by more than a tenth of their interval
it says so. All switches are built at once into a copy (target/ablate), so that a try costs its judges and no build.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from build import Ablated

ROOT = Path(__file__).resolve().parents[2]
HERE = ROOT / "target" / "ablate"


class Judge:
    """A set or a test: how it is called, and what is right."""

    def __init__(self, name, words, folder, is_set):
        self.name, self.words, self.folder, self.is_set = name, words, folder, is_set

    def call(self, environment, limit):
        """The status and what was printed; None if it had to be ended."""
        try:
            done = subprocess.run(
                self.words, cwd=self.folder, env=os.environ | {"RAYON_NUM_THREADS": "1"} | environment, capture_output=True, text=True, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return None
        return done.returncode, done.stdout if self.is_set else ""


def sets(folders, judge):
    for folder in folders:
        manifest = folder / "manifest.toml"
        rows = tomllib.loads(manifest.read_text())["set"] if manifest.exists() else [{"dir": ".", "args": []}]
        for row in rows:
            without = [word for word in row["args"] if not word.startswith("--")]
            words = [judge, str(ROOT / "target" / "fmus"), str((folder / row["dir"]).resolve()), *without]
            yield Judge((folder / row["dir"]).resolve().name, words, ROOT, True)


def tests(programs, folder):
    for program in programs:
        listed = subprocess.run([program, "--list", "--format", "terse"], cwd=folder, capture_output=True, text=True, check=True).stdout
        for line in listed.splitlines():
            if line.endswith(": test"):
                test = line.removesuffix(": test")
                name = f"{re.sub('-[0-9a-f]{16}$', '', Path(program).name)}::{test}"
                yield Judge(name, [program, "--exact", test, "--test-threads=1"], folder, False)


def told(text):
    """Verdict with names and members, and the values with their intervals."""
    try:
        found = json.loads(text)
    except json.JSONDecodeError:
        return ("nothing readable",), []
    if "error" in found:
        return ("error", found["error"]), []
    effects = found["effects"]
    names = tuple(sorted(tuple(sorted(effect["class"])) for effect in effects))
    correction = tuple(sorted(term["name"] for term in (found.get("correction") or {}).get("terms", []) if "name" in term))
    values = [(effect["value"], effect["ci95"]) for effect in sorted(effects, key=lambda effect: sorted(effect["class"]))]
    return (found["verdict"], names, correction), values


def compared(before, after):
    """'same', 'moved' or 'changed'."""
    if before == after:
        return "same"
    (verdict, values), (other, others) = told(before), told(after)
    if verdict != other:
        return "changed"
    for (value, ci), (new, _) in zip(values, others):
        width = abs((ci[1] or 0) - (ci[0] or 0)) if ci and None not in ci else 0.0
        if value is not None and new is not None and abs(new - value) > 0.1 * width + 1e-12 * abs(value):
            return "moved"
    return "slightly"


def reach(judges, jobs):
    """Each judge once: seconds, what it said, which points it came to and which way they went."""

    def once(judge):
        with tempfile.NamedTemporaryFile("r") as seen:
            began = time.monotonic()
            done = judge.call({"ABLATE_SEEN": seen.name}, 600)
            took = time.monotonic() - began
            points = {}
            for line in seen.read().splitlines():
                place, bit = map(int, line.split())
                points[place] = points.get(place, 0) | bit
        if done is None or done[0] != 0:
            print(f"  {judge.name} does not pass here and is left out", flush=True)
            return None
        return {"name": judge.name, "words": judge.words, "folder": str(judge.folder), "is_set": judge.is_set, "seconds": took,
                "said": done[1], "points": points}  # fmt: skip

    with ThreadPoolExecutor(jobs) as pool:
        return [found for found in pool.map(once, judges) if found]


def wanted(words, points):
    """What a judge must have seen for these words to matter to it: a point, and for a condition the other way."""
    needs = []
    for word in words.split(","):
        place, sign = int(re.match(r"\d+", word)[0]), re.search(r"[-+*]", word)[0]
        needs.append((place, {"+": 2, "-": 1, "*": 1}[sign]))
    return needs


def attempt(words, known, only_sets=False):
    """The judges that notice: the first that changes ends it. Answers with (how, who, how many were asked)."""
    needs = wanted(words, known)
    asked = [j for j in known["judges"] if any(int(j["points"].get(str(p), 0)) & bit for p, bit in needs)]
    asked = [j for j in asked if j["is_set"] or not only_sets]
    worst, slight = None, 0
    for row in sorted(asked, key=lambda row: (not row["is_set"], row["seconds"])):
        judge = Judge(row["name"], row["words"], row["folder"], row["is_set"])
        done = judge.call({"ABLATE": words}, 10 + 6 * row["seconds"])
        if done is None or done[0] != 0:
            return "changed" if done else "hangs", row["name"], len(asked)
        if row["is_set"]:
            how = compared(row["said"], done[1])
            if how == "changed":
                return "changed", f"{row['name']} {told(row['said'])[0]} -> {told(done[1])[0]}", len(asked)
            slight += how == "slightly"
            worst = worst or (row["name"] if how == "moved" else None)
    if worst:
        return "moved", worst, len(asked)
    return ("same" if not slight else "slightly"), "", len(asked)


def described(words, known):
    return "; ".join(f"{word} {known['points'][re.match(r'[0-9]+', word)[0]]}" for word in words.split(","))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["reach", "list", "try", "all"])
    parser.add_argument("words", nargs="*")
    parser.add_argument("--sets", type=Path, nargs="*", default=[], help="more sets, or folders of them with a manifest.toml")
    parser.add_argument("--file", nargs="*", default=[], help="only points of files whose path holds one of these")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only-sets", action="store_true", help="tests are no judges (and aren't built)")
    parser.add_argument("--ways", default="0.25,4", help="what numbers are multiplied by (default 0.25,4)")
    arguments = parser.parse_args()
    record = HERE / "reach.json"
    if arguments.what == "reach":
        ablated = Ablated(ROOT, HERE / "copy", ROOT / "target")
        ablated.duplicate()
        found, judge, programs = ablated.build(ablated.points(), not arguments.only_sets)
        print(f"{len(found)} points", flush=True)
        folders = [ROOT / "out" / "blind" / "sets", ROOT / "examples" / "hidden-effect", *arguments.sets]
        judges = [*sets([f for f in folders if f.exists()], judge), *tests(programs, ablated.copy / "diagnosis")]
        shown = {p.number: {"kind": p.kind, "text": str(p), "file": p.file} for p in found}
        record.write_text(json.dumps({"points": {n: p["text"] for n, p in shown.items()}, "kinds": {n: p["kind"] for n, p in shown.items()},
                                      "judges": reach(judges, arguments.jobs)}))  # fmt: skip
        return
    known = json.loads(record.read_text())
    chosen = [n for n, text in known["points"].items() if not arguments.file or any(f in text for f in arguments.file)]
    if arguments.what == "list":
        for place in chosen:
            by_sets = [int(j["points"].get(place, 0)) for j in known["judges"] if j["is_set"]]
            by_tests = [int(j["points"].get(place, 0)) for j in known["judges"] if not j["is_set"]]
            ways = lambda seen: f"{sum(bool(s & 1) for s in seen)}+ {sum(bool(s & 2) for s in seen)}-"  # noqa: E731
            print(f"{known['points'][place]}   [sets {ways(by_sets)}; tests {ways(by_tests)}]")
        return
    if arguments.what == "all":
        words = []
        for place in chosen:
            words += [f"{place}-", f"{place}+"] if known["kinds"][place] == "condition" else [f"{place}*{w}" for w in arguments.ways.split(",")]
    else:
        words = arguments.words

    def one(word):
        how, who, asked = attempt(word, known, arguments.only_sets)
        print(f"{how:9} {asked:3} {described(word, known)}  {who}", flush=True)

    with ThreadPoolExecutor(arguments.jobs) as pool:
        list(pool.map(one, words))


if __name__ == "__main__":
    sys.exit(main())
