"""The command line."""

import argparse
import json
import resource
import shlex
import subprocess
import time
from pathlib import Path

import numpy as np

from . import score, sets
from .machines import ALL
from .unit_python import environment


def part(text):
    """K/N, from 1: every Nth set, so that machines share a folder."""
    k, n = (int(number) for number in text.split("/"))
    if not 1 <= k <= n:
        raise ValueError(text)
    return k, n


def listed_in(folder, partition):
    """The file that names the sets of a part."""
    return folder / "part-{}-of-{}.txt".format(*partition)


def main():
    parser = argparse.ArgumentParser(prog="hidden_any", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    make = commands.add_parser("make", help="data sets, and their answers apart")
    make.add_argument("--machine", nargs="*", default=list(ALL), choices=list(ALL))
    make.add_argument("--case", nargs="*", help="effects, none, unlisted, door; random ones if not given")
    make.add_argument("--count", type=int, default=10, help="sets a machine, where no case is given")
    make.add_argument("--slice", action="store_true", help="the fixed cases of the tests")
    make.add_argument("--seed", type=int, default=1)
    make.add_argument("--partition", type=part, metavar="K/N", help="only every Nth set, from the Kth")
    make.add_argument("--out", type=Path, required=True)
    make.add_argument("--answers", type=Path, required=True)
    diagnose = commands.add_parser("diagnose", help="runs a diagnosis on every set")
    diagnose.add_argument("sets", type=Path)
    diagnose.add_argument("out", type=Path)
    diagnose.add_argument("--command-line", default="acroscope")
    diagnose.add_argument("--partition", type=part, metavar="K/N", help="only the sets that were made with the same")
    judge = commands.add_parser("score", help="judges diagnoses by the answers")
    judge.add_argument("diagnoses", type=Path)
    judge.add_argument("answers", type=Path)
    judge.add_argument("--sets", type=Path, help="also run the amended scenarios in FMPy against left-out data")
    judge.add_argument("--out", type=Path, help="score.json")
    arguments = parser.parse_args()
    globals()[f"do_{arguments.command}"](arguments)


def chosen(arguments):
    """(machine, case, seed, name of the folder)"""
    if arguments.slice:
        pairs = sets.slice_of(arguments.machine)
    elif arguments.case:
        pairs = [(ALL[name], case) for name in arguments.machine for case in arguments.case]
    else:
        rng, pairs = np.random.default_rng(arguments.seed), []
        for name in arguments.machine:
            every = sets.cases(ALL[name])
            # none and what nobody lists in a sixth each
            weights = np.array([len(every) / 6 if case in ("none", "door") else 1.0 for case in every])
            pairs += [(ALL[name], rng.choice(every, p=weights / weights.sum())) for _ in range(arguments.count)]
    return [(machine, str(case), arguments.seed + place, f"{machine.name}-{place:03d}") for place, (machine, case) in enumerate(pairs)]


def do_make(arguments):
    arguments.out.mkdir(parents=True, exist_ok=True)
    wanted = chosen(arguments)
    built = arguments.out / ".units"
    if arguments.partition:
        k, n = arguments.partition
        wanted, built = wanted[k - 1 :: n], arguments.out / f".units-{k}-of-{n}"
    built.mkdir(exist_ok=True)
    units = {machine.name: machine.build(machine, built) for machine in {m.name: m for m, *_ in wanted}.values()}
    for machine, case, seed, name in wanted:
        answer = sets.make(machine, case, seed, arguments.out / name, arguments.answers, units)
        print(f"{name}  {answer['verdict']}", flush=True)
    if arguments.partition:
        listed_in(arguments.out, arguments.partition).write_text("".join(f"{name}\n" for *_, name in wanted))


def do_diagnose(arguments):
    folders = sorted(folder for folder in arguments.sets.iterdir() if (folder / "dataset.toml").is_file())
    if arguments.partition:
        mine = listed_in(arguments.sets, arguments.partition).read_text().split()
        folders = [folder for folder in folders if folder.name in mine]
    for folder in folders:
        began, spent = time.monotonic(), cpu()
        out = arguments.out / folder.name
        command = [*shlex.split(arguments.command_line), "--quiet", "diagnose", str(folder), "--out", str(out)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment())
        out.mkdir(parents=True, exist_ok=True)
        seconds, spent = round(time.monotonic() - began, 2), round(cpu() - spent, 2)
        (out / "call.json").write_text(json.dumps({"exit": done.returncode, "error": done.stderr[-2000:], "seconds": seconds, "cpu": spent}))
        print(f"{folder.name}  exit {done.returncode}  {seconds} s, {spent} s of CPU", flush=True)


def cpu():
    """Seconds that the processors spent on finished diagnoses: what others run beside them doesn't count."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def do_score(arguments):
    result = score.score(arguments.diagnoses, arguments.answers, arguments.sets)
    print(score.text(result))
    if arguments.out:
        arguments.out.write_text(json.dumps(result, indent=1))
