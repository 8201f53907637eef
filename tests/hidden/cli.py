"""Command line: python -m hidden {make, one, slice, mde, diagnose, follow, score, compare}."""

import argparse
import json
import os
import subprocess
import tempfile
import time
import tomllib
from pathlib import Path

from . import parts, sets
from .effects import BY_NAME, UNKNOWN
from .settings import MIXES, Setting, off_value


def _where(p):
    p.add_argument("--out", required=True, help="folder for the data sets")
    p.add_argument("--answers", required=True, help="folder for the answers; must lie outside --out")
    p.add_argument("--salt", default=sets.SALT, help="changes every random number (blind sets: a secret one)")


def part(text):
    """K/N, from 1: every Nth set, so that machines share a folder."""
    k, n = (int(number) for number in text.split("/"))
    if not 1 <= k <= n:
        raise ValueError(text)
    return k, n


def _parser():
    top = argparse.ArgumentParser(prog="hidden", description="Independent maker and scorer of blind test data.")
    sub = top.add_subparsers(dest="command", required=True)
    p = sub.add_parser("make", help="a part of the benchmark")
    p.add_argument("--part", choices=(*parts.PARTS, "all"), required=True)
    p.add_argument("--count", type=int, default=20)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--partition", type=part, metavar="K/N", help="only every Nth set, from the Kth")
    _where(p)
    p = sub.add_parser("slice", help="some two dozen sets for CI")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--partition", type=part, metavar="K/N", help="only every Nth set, from the Kth")
    _where(p)
    p = sub.add_parser("one", help="one set of your choice")
    p.add_argument("--effect", action="append", default=[], help=f"{', '.join(BY_NAME)}")
    p.add_argument("--size", action="append", default=[], help="distance from the neutral value (limits: the limit); `10x` = MDE")
    p.add_argument("--unknown", choices=list(UNKNOWN))
    p.add_argument("--unknown-size", type=float)
    p.add_argument("--rig", choices=list(MIXES), default="visual")
    p.add_argument("--logs", choices=("all", "plant", "image"))
    p.add_argument("--noise", choices=parts.NOISES, default="mid")
    p.add_argument("--mix", default="mixed", help="; ".join(f"{k}: {', '.join(v)}" for k, v in MIXES.items()))
    p.add_argument("--arm", type=int, default=0)
    p.add_argument("--applied", action="store_true", help="tau_applied is logged")
    p.add_argument("--rates", action="store_true", help="dq1, dq2 are logged")
    p.add_argument("--turned", action="store_true", help="camera mounted turned by 90 degrees")
    p.add_argument("--no-velocity", action="store_true", help="the nominal model lacks the velocity terms")
    p.add_argument("--jitter", type=float, default=0.0)
    p.add_argument("--clock-offset", type=float, default=0.0)
    p.add_argument("--seed", type=int, default=1)
    _where(p)
    p = sub.add_parser("mde", help="complete mde.toml")
    p.add_argument("--jobs", type=int, default=1)
    p = sub.add_parser("diagnose", help="run a diagnosis over all sets of a folder, with the manifest's arguments")
    p.add_argument("sets")
    p.add_argument("diagnoses")
    p.add_argument("--command-line", default="cargo acroscope", help="what comes before `diagnose SET --out DIR`")
    p.add_argument("--jobs", type=int, default=1, help="sets at once, one thread each (default 1, with all cores)")
    p.add_argument("--partition", type=part, metavar="K/N", help="only the sets that were made with the same")
    p = sub.add_parser("follow", help="make the sets of the experiments that diagnoses of the part `classes` proposed")
    p.add_argument("diagnoses")
    p.add_argument("truths", help="answers of the sets that were diagnosed")
    _where(p)
    p = sub.add_parser("compare", help="the measures of several methods side by side, the first against the others")
    p.add_argument("methods", nargs="+", metavar="NAME=DIAGNOSES", help="e.g. ours=out/ours bic=out/bic")
    p.add_argument("--answers", nargs="+", required=True, help="folders of answers, judged together")
    p = sub.add_parser("score", help="open the answers and judge diagnoses")
    p.add_argument("diagnoses")
    p.add_argument("answers")
    p.add_argument("--out", default="score.json")
    p.add_argument("--sets", help="folder of the data sets: the gap is then computed again, from amended.toml")
    p.add_argument("--units", default=str(Path(__file__).resolve().parents[2] / "target" / "fmus"), help="the packed units for that")
    return top


def _manifest_of(partition):
    return "manifest-{}-of-{}.toml".format(*partition) if partition else "manifest.toml"


def _manifest(out, rows, partition):
    text = ["# Sets made here, and extra arguments that a diagnosis of each has to be given."]
    file = Path(out) / _manifest_of(partition)
    known = {r["dir"]: r["args"] for r in tomllib.loads(file.read_text()).get("set", [])} if file.exists() else {}
    known |= {name: (["--without", "camera.k2"] if part == "unknown" else []) + more for name, part, more in rows}
    for name, args in sorted(known.items()):
        text += ["", "[[set]]", f'dir = "{name}"', f"args = {json.dumps(args)}"]
    file.write_text("\n".join(text) + "\n")


def _made(spec, args):
    return parts.make(spec, args.out, args.answers, args.salt), spec.part, []


def _apart(args):
    out, answers = Path(args.out).resolve(), Path(args.answers).resolve()
    if answers == out or out in answers.parents:
        raise SystemExit(f"--answers {answers} lies inside --out {out}: the diagnosis would see it")


def _write_all(specs, args, jobs=1, earlier=()):
    _apart(args)
    partition = getattr(args, "partition", None)
    if partition:
        specs = specs[partition[0] - 1 :: partition[1]]
    start, rows = time.time(), []
    if jobs > 1:
        from concurrent.futures import ProcessPoolExecutor

        with ProcessPoolExecutor(jobs) as pool:
            rows = list(pool.map(_made, specs, [args] * len(specs)))
    else:
        for spec in specs:
            rows.append(_made(spec, args))
    rows = [(*row[:2], ["--after", str(folder)]) for row, folder in zip(rows, earlier)] if earlier else rows
    _manifest(args.out, rows, partition)
    print(f"{len(rows)} sets in {time.time() - start:.1f} s -> {args.out}")


def _one(args):
    logs = args.logs or ("all" if args.rig == "visual" else "plant")
    setting = Setting(args.rig, logs, args.noise, args.mix, args.arm, args.applied, not args.no_velocity, args.turned)
    if args.mix not in MIXES[args.rig]:
        raise SystemExit(f"--mix {args.mix}: one of {', '.join(MIXES[args.rig])} for the rig {args.rig}")
    if len(args.effect) != len(args.size):
        raise SystemExit("each --effect needs a --size")
    effects, sign = [], 1.0
    for name, size in zip(args.effect, args.size):
        if name not in BY_NAME:
            raise SystemExit(f"--effect {name}: none of {', '.join(BY_NAME)}")
        e = BY_NAME[name]
        if size.endswith("x"):
            m = float(size[:-1])
            sign = 1.0 if m > 0 else -1.0
            got = parts.sized(name, setting, abs(m), sign)
            if got is None:
                raise SystemExit(f"--size {size}: {name} cannot be seen in the setting {setting.key}")
            effects.append((name, *got))
        else:
            v = float(size)
            sign = 1.0 if v >= 0 else -1.0
            unit = parts.mde.of(setting).get(name, {}).get("mde", float("nan"))
            value = {"limit": v, "switch": 1.0 - off_value(e, setting)}.get(e.shape, off_value(e, setting) + v)
            effects.append((name, value, abs(v) / unit))
    unknown = None
    if args.unknown:
        unknown = (args.unknown, args.unknown_size if args.unknown_size is not None else UNKNOWN[args.unknown][2])
    spec = sets.Spec(setting, effects, unknown, "one", args.seed, args.jitter, args.clock_offset, args.rates, {"sign": sign})
    _write_all([spec], args)


def _rows(sets_folder, partition):
    return tomllib.loads((Path(sets_folder) / _manifest_of(partition)).read_text()).get("set", [])


def _diagnosed(row, args, threads):
    out = Path(args.diagnoses) / row["dir"]
    out.mkdir(parents=True, exist_ok=True)
    (out / "diagnosis.json").unlink(missing_ok=True)  # of an earlier run: this one may fail
    command = [*args.command_line.split(), "diagnose", str(Path(args.sets) / row["dir"]), "--out", str(out), *row["args"]]
    status, said, spent = _spent(command, {**os.environ, **threads})
    (out / "seconds.txt").write_text(f"{spent:.2f}\n")
    if status != 0:
        print(f"{row['dir']}: exit {status}: {said.strip()[-300:]}")


def _spent(command, environment):
    """Exit status, what was said on standard error, and seconds of processor time, which other work on the machine hardly changes."""
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said, env=environment)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return child.returncode, said.read().decode(errors="replace"), usage.ru_utime + usage.ru_stime


def _diagnose(args):
    """One after the other with all cores each, or `--jobs` at once with one thread each."""
    from concurrent.futures import ThreadPoolExecutor

    rows = _rows(args.sets, args.partition)
    threads = {"RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"} if args.jobs > 1 else {}
    with ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(lambda row: _diagnosed(row, args, threads), rows))
    return 0


def _follow(args):
    specs, earlier = [], []
    for file in sorted(Path(args.truths).glob("*/answer.toml")):
        answer = tomllib.loads(file.read_text())
        found = Path(args.diagnoses) / file.parent.name / "diagnosis.json"
        if answer.get("stage") != "before" or not found.exists():
            continue
        proposal = (json.loads(found.read_text()).get("next_experiment") or {}).get("do", "")
        spec = parts.follow(answer, proposal)
        if spec is None:
            print(f"{file.parent.name}: no experiment understood in {proposal!r}")
        else:
            specs.append(spec)
            earlier.append(found.parent.resolve())
    _write_all(specs, args, earlier=earlier)


def main(argv=None):
    args = _parser().parse_args(argv)
    if args.command == "make":
        chosen = parts.PARTS if args.part == "all" else (args.part,)
        _write_all([s for p in chosen for s in parts.specs(p, args.count, args.seed)], args, args.jobs)
    elif args.command == "slice":
        _write_all(list(parts.ci_slice(args.seed)), args)
    elif args.command == "one":
        _one(args)
    elif args.command == "mde":
        parts.mde.make_table(args.jobs)
    elif args.command == "diagnose":
        return _diagnose(args)
    elif args.command == "follow":
        _follow(args)
    elif args.command == "compare":
        from .compare import compare

        return compare(args.methods, args.answers)
    elif args.command == "score":
        from .score import score

        return score(args.diagnoses, args.answers, args.out, args.sets, args.units)
    return 0
