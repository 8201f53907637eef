"""Blind data sets of machines that the product doesn't know, diagnosed and scored: a deterministic slice (in the tests), or more.

    python scripts/blind_any.py                        the slice
    python scripts/blind_any.py --count 20 --seed 7    20 random sets of each machine
    python scripts/blind_any.py --count 20 --partition 3/16 --out /shared    a part on one of 16 machines; then, on any of them,
    python scripts/blind_any.py --count 20 --join 16 --out /shared           their score

The sets come from tests/hidden_any, which shares no code and no numerics with the product. Answers lie apart and are opened by the
scorer afterwards. Prints a row a set and the measures; exit status 1 if the slice got worse.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import partition

ROOT = Path(__file__).resolve().parent.parent
# What the slice must keep, and what it was when the gate was set. They say that nothing got worse, not that targets are met.
GATES = ROOT / "tests" / "hidden_any" / "gates.json"


def hidden(*arguments):
    subprocess.run([sys.executable, "-m", "hidden_any", *map(str, arguments)], cwd=ROOT / "tests", check=True)


def failures(score):
    for name, bound in json.loads(GATES.read_text()).items():
        value = score["measures"][name]["value"]
        if value is None or value < bound:
            yield f"{name}: {value}, must be at least {bound}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, help="sets of each machine instead of the slice")
    parser.add_argument("--machine", nargs="*", help="only these machines")
    parser.add_argument("--seed", type=int, default=1, help="of the sets (default 1)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "blind-any", help="folder (default out/blind-any)")
    partition.add_to(parser)
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    asked = {"count": arguments.count, "machine": arguments.machine, "seed": arguments.seed}
    sets, answers, diagnoses = out / "sets", out / "answers", out / "diagnoses"
    what = ["--count", arguments.count] if arguments.count else ["--slice"]
    machines = ["--machine", *arguments.machine] if arguments.machine else []
    if arguments.join:
        partition.require_all(out, arguments.join, asked)
    else:
        part = partition.passed_on(arguments)
        hidden("make", *what, *machines, "--seed", arguments.seed, "--out", sets, "--answers", answers, *part)
        hidden("diagnose", sets, diagnoses, "--command-line", ROOT / "target" / "release" / "acroscope", *part)
        if arguments.partition:
            partition.finish(out, arguments.partition, asked)
            return
    hidden("score", diagnoses, answers, "--sets", sets, "--out", out / "score.json")
    if not arguments.count:
        found = list(failures(json.loads((out / "score.json").read_text())))
        sys.exit("\n".join(["the slice got worse:", *found]) if found else 0)


if __name__ == "__main__":
    main()
