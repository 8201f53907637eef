"""What faults the tests let through: each change of a crate (a sign, a limit, an answer) against the tests that reach it.

    python scripts/mutants mechanics fmus/plant          all changes of these crates
    python scripts/mutants --shard 3/12                  the fourth of twelve parts of all crates': a night's work
    python scripts/mutants orchestrator --again LOG      what an earlier run missed, by what it printed

All changes of a crate are built at once, each behind a switch that an environment variable turns, so that a change costs
its tests and no build. Every test is run once alone to see which changes it reaches; then each change meets the tests that
reach it, the quickest first, until one fails. Prints the counts of each crate and every change that no test noticed; ends with
status 1 where less than 95 % of them were. Those that change nothing that can be seen stand in scripts/mutants/equal.txt.
"""

import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from build import Crate

ROOT = Path(__file__).resolve().parents[2]
CRATES = ["mechanics", "fmi2-export", "fmus/plant", "fmus/camera", "fmus/controller", "fmus/residual", "fmus/signal_effects",
          "report", "export", "orchestrator"]  # fmt: skip
GOAL = 0.95


def call(words, folder, environment, limit):
    """The status of a test, None if it had to be ended."""
    child = subprocess.Popen(
        words, cwd=folder, env=os.environ | environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        return child.wait(limit)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        return None


def tests_of(program, folder):
    listed = subprocess.run([program, "--list", "--format", "terse"], cwd=folder, capture_output=True, text=True, check=True).stdout
    return [line.removesuffix(": test") for line in listed.splitlines() if line.endswith(": test")]


def reached(programs, folder):
    """Every test with its time and the changes it reaches, the quickest first. Those that fail here are no judges."""
    found = []
    for program in programs:
        for test in tests_of(program, folder):
            words = [program, "--exact", test, "--test-threads=1"]
            with tempfile.NamedTemporaryFile("r") as seen:
                began = time.monotonic()
                status = call(words, folder, {"MUTANTS_SEEN": seen.name}, 600)
                took = time.monotonic() - began
                numbers = {int(line) for line in seen.read().split()}
            if status == 0:
                found.append((took, words, numbers))
            else:
                print(f"  {test} does not pass here and is left out", flush=True)
    return sorted(found, key=lambda entry: entry[0])


def equal():
    """Lines `FILE: WHAT`, of changes that change nothing that can be seen."""
    lines = (Path(__file__).parent / "equal.txt").read_text().splitlines()
    return {line.strip() for line in lines if line.strip() and not line.startswith("#")}


def try_crate(folder, arguments, known):
    crate = Crate(ROOT, folder, ROOT / "target" / "mutants" / folder.replace("/", "-"), ROOT / "target" / "mutants" / "build")
    crate.duplicate()
    found = [change for change in crate.changes() if not arguments.file or any(name in change.file for name in arguments.file)]
    for number, change in enumerate(found, 1):
        change.number = number
    kept, programs = crate.build(found)
    tests = reached(programs, crate.copy / folder)
    index, of = (int(part) for part in arguments.shard.split("/"))
    kept = [change for change in kept if change.number % of == index and f"{change.file}: {change.what}" not in known]
    if arguments.again:
        missed = {line.removeprefix("  missed ").split("  [")[0] for line in Path(arguments.again).read_text().splitlines()}
        missed = {re.sub(r":\d+: ", ": ", change, count=1) for change in missed}
        kept = [change for change in kept if f"{change.file}: {change.what}" in missed]
    print(f"{folder}: {len(kept)} changes of {len(found)}, {len(tests)} tests", flush=True)
    missed = []
    for change in kept:
        for took, words, numbers in tests:
            # Ten times as long and a quarter of a minute: it does not come back.
            if change.number in numbers and call(words, crate.copy / folder, {"MUTANT": str(change.number)}, 15 + 10 * took) != 0:
                break
        else:
            unseen = "" if any(change.number in numbers for *_, numbers in tests) else "  [no test comes here]"
            missed.append(f"{change}{unseen}")
            print(f"  missed {change}{unseen}", flush=True)
    return len(kept), missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crates", nargs="*", default=CRATES, help=f"folders (default {' '.join(CRATES)})")
    parser.add_argument("--shard", default="0/1", help="K/N: part K, from 0, of N")
    parser.add_argument("--file", nargs="*", default=[], help="only files whose path holds one of these")
    parser.add_argument("--again", help="what an earlier run printed: only what it missed")
    arguments = parser.parse_args()
    known = equal()
    bad = []
    for folder in arguments.crates:
        count, missed = try_crate(folder.rstrip("/"), arguments, known)
        caught = count - len(missed)
        print(f"{folder}: {caught} of {count} noticed ({100 * caught / max(count, 1):.1f} %)", flush=True)
        if caught < GOAL * count:
            bad.append(folder)
    sys.exit(f"below {100 * GOAL:.0f} %: {', '.join(bad)}" if bad else 0)


if __name__ == "__main__":
    main()
