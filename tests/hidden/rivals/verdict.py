"""Runs a rival over data sets and writes what it says as diagnosis.json (CONTRACT.md, section 6)."""

import json
import os
import time
import traceback
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from .data import load


def diagnosis(effects):
    """effects: [(effect, value, standard error or None, probability or None)], best first. What a rival cannot say is null."""
    rows = []
    for effect, value, error, probability in effects:
        value = float(value)
        ci95 = None if error is None else [value - 1.96 * float(error), value + 1.96 * float(error)]
        rows.append({"name": effect.name, "class": [effect.name], "value": value, "ci95": ci95, "probability": probability})
    return {"verdict": "named" if rows else "none", "effects": rows, "where": [],
            "gap": {"before": None, "after": None, "floor": None, "closed": None, "held_out_runs": []},
            "unknown": None, "next_experiment": None, "minimum_detectable": {}}


def without(args):
    """Names withheld by the manifest's extra arguments."""
    names, rest = set(), list(args)
    while rest:
        if rest[0] != "--without" or len(rest) < 2:
            raise SystemExit(f"manifest.toml: {rest[0]!r}: a rival knows only `--without NAME`")
        names.add(rest[1])
        del rest[:2]
    return names


def one(kind, folder, names, out):
    """Diagnoses one set; a set that breaks a rival has no diagnosis and counts as wrong."""
    start = time.time()
    try:
        if kind == "bic":
            from .bic import diagnose
        else:
            from .sindy import diagnose
        said = diagnosis(diagnose(load(folder, names)))
    except Exception:  # whatever it was, the other sets go on
        return f"{folder}: {traceback.format_exc(limit=-2)}"
    out.mkdir(parents=True, exist_ok=True)
    (out / "diagnosis.json").write_text(json.dumps(said, indent=1))
    (out / "seconds.txt").write_text(f"{time.time() - start:.2f}\n")
    return None


def run(kind, sets, rows, diagnoses, jobs):
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # read by the children, where numpy starts anew
    work = [(Path(sets) / r["dir"], without(r["args"]), Path(diagnoses) / r["dir"]) for r in rows]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        waiting = [pool.submit(one, kind, *w) for w in work]
        broken = [text for text in (done.result() for done in waiting) if text]
    print(*broken, f"{len(rows) - len(broken)} of {len(rows)} sets diagnosed by {kind} -> {diagnoses}", sep="\n")
    return 0
