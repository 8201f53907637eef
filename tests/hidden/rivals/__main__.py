"""A rival behind the product's command line: python -m hidden.rivals [--units DIR] KIND diagnose SET --out DIR [--without NAME].

So `python -m hidden diagnose` runs a rival as it runs the product: a process for each set, and a set that breaks it is
reported, stays without a diagnosis and counts as wrong.
"""

import argparse
import importlib
import json
import os
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small; read when numpy starts, so before it does


def diagnosis(effects):
    """diagnosis.json (docs/diagnosis-json.md) of [(names, value, standard error or None, probability or None)], best first.

    names: the effect and those that the rival cannot tell from it. What a rival cannot say is null.
    """
    rows = []
    for names, value, error, probability in effects:
        value = float(value)
        ci95 = None if error is None else [value - 1.96 * float(error), value + 1.96 * float(error)]
        rows.append({"name": names[0], "class": list(names), "value": value, "ci95": ci95, "probability": probability})
    open_ = any(len(r["class"]) > 1 for r in rows)
    return {"verdict": "ambiguous" if open_ else "named" if rows else "none", "effects": rows, "where": [],
            "gap": {"before": None, "after": None, "floor": None, "closed": None, "held_out_runs": []},
            "unknown": None, "next_experiment": None, "minimum_detectable": {}}


def main(argv=None):
    parser = argparse.ArgumentParser(prog="hidden.rivals", description="A rival of the diagnosis.")
    parser.add_argument("--units", metavar="DIR", help="predict with the product's units in this folder, not with the maker's own "
                        "machine and camera (not sindy)")
    parser.add_argument("kind", choices=("sindy", "bic", "stepwise"))
    parser.add_argument("verb", choices=("diagnose",))
    parser.add_argument("set", help="data set folder")
    parser.add_argument("--out", required=True, help="folder for diagnosis.json")
    parser.add_argument("--without", action="append", default=[], metavar="NAME", help="an effect that may not be named")
    args = parser.parse_args(argv)
    from .data import load

    if args.units and args.kind == "sindy":
        parser.error("--units: sindy has equations of its own and calls no unit; leave it out")
    world = None
    if args.units:
        from .units import Units

        world = Units(args.units)
    data = load(args.set, args.without, world)
    rival = importlib.import_module(f".{args.kind}", __package__)
    said = diagnosis(rival.diagnose(data))
    out = Path(args.out)
    out.mkdir(parents=True, exist_ok=True)
    (out / "diagnosis.json").write_text(json.dumps(said, indent=1))


if __name__ == "__main__":
    main()
