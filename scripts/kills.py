#!/usr/bin/env python3
"""Kills a run at random moments with SIGKILL, resumes it each time, and compares what it leaves with what a run leaves that nobody
disturbed: the same bytes, or exit status 1.

A run that comes to its end before it is killed counts for nothing, but its files are compared, too; the next one begins from an
empty folder.
"""

import argparse
import hashlib
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# They say how long the run took on the clock.
TIMED = ("report.html", "summary.json")


def sums(folder):
    """Of all files, frames included."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name not in TIMED)
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "target" / "release" / "acroscope")
    parser.add_argument("--scenario", default="visual-servo")
    parser.add_argument("--stop", default="600", help="simulated seconds of a run")
    parser.add_argument("--checkpoint", default="1", help="simulated seconds between checkpoints")
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    dice = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        base = [arguments.program, "--quiet", "run", arguments.scenario, "--stop", arguments.stop, "--checkpoint", arguments.checkpoint]
        # The same folder for both: its path stands in resolved.toml, where frames are kept.
        base += ["--out", out := folder / "run"]
        began = time.monotonic()
        subprocess.run(base, check=True)
        whole = time.monotonic() - began
        expected, size = sums(out), (out / "results.csv").stat().st_size
        print(f"{arguments.scenario} to {arguments.stop} s: {whole:.2f} s undisturbed, {len(expected)} files, results.csv of {size} bytes", flush=True)
        shutil.rmtree(out)
        kills, ends, places = 0, 0, Counter()
        while kills < arguments.kills or ends == 0:
            process = subprocess.Popen([*base, "--resume"])
            patience = dice.uniform(0, whole / 3) if kills < arguments.kills else None
            try:
                status = process.wait(patience)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                kills += 1
                rows = out / "results.csv"
                written = rows.stat().st_size if rows.is_file() else -1
                places["before any row" if written <= 0 else f"in quarter {min(4 * written // size, 3) + 1}"] += 1
                continue
            if status:
                sys.exit(f"after {kills} kills the run ended with exit status {status}")
            ends += 1
            found = sums(out)
            if found != expected:
                differ = [name for name in sorted({*found, *expected}) if found.get(name) != expected.get(name)]
                sys.exit(f"after {kills} kills these files differ: {', '.join(differ)}")
            shutil.rmtree(out)
        where = ", ".join(f"{count} {place}" for place, count in sorted(places.items()))
        print(f"{kills} kills ({where}); {ends} runs came to their end, all with the same bytes")


if __name__ == "__main__":
    main()
