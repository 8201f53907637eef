"""Opens the answers after the diagnoses are done and prints the measures, with n and Wilson intervals.

DIAGNOSES holds SET/diagnosis.json (and, where known, SET/seconds.txt with the processor time); ANSWERS holds SET/answer.toml.
A set without a diagnosis counts as wrong. Rivals leave null what they cannot state; such an entry joins no measure of it.
"""

import json
import math
import tomllib
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np

Z = 1.959964
OVERCLAIMED = 0.1  # a share of angles isn't quite one of torques


def wilson(k, n):
    if n == 0:
        return 0.0, 1.0
    p = k / n
    middle = (p + Z * Z / (2 * n)) / (1 + Z * Z / n)
    half = Z / (1 + Z * Z / n) * math.sqrt(p * (1 - p) / n + Z * Z / (4 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)


def members(effect):
    return effect.get("class") or [effect["name"]]


def named(diagnosis):
    return (diagnosis or {}).get("effects") or []


def right_single(answer, diagnosis):
    """One effect, the true one, or (where only a class can be known) a class that holds it and nothing distinguishable."""
    found = named(diagnosis)
    if not found or len(found) != 1 or diagnosis.get("verdict") == "unknown":
        return False
    truth, group = answer["effect"][0], set(members(found[0]))
    wide = set(truth.get("class_wide", [])) | set(truth.get("class", [])) | {truth["name"]}
    if not group <= wide:
        return False
    return truth["name"] in group if len(truth.get("class", [])) > 1 else found[0]["name"] == truth["name"]


def touched(name, diagnosis):
    return any(name in members(e) for e in named(diagnosis))


class Tally:
    def __init__(self):
        self.rows = {}

    def share(self, key, hits, goal, text):
        n, k = len(hits), sum(map(bool, hits))
        lo, hi = wilson(k, n)
        value = k / n if n else None
        self.rows[key] = {"text": text, "value": value, "n": n, "ci95": [lo, hi], "goal": goal, "holds": _holds(value, goal)}

    def number(self, key, values, goal, text, reduce=np.median):
        value = float(reduce(values)) if len(values) else None
        self.rows[key] = {"text": text, "value": value, "n": len(values), "goal": goal, "holds": _holds(value, goal)}


def _holds(value, goal):
    if value is None:
        return None
    if isinstance(goal, (list, tuple)):
        return goal[0] <= value <= goal[1]
    return value >= float(goal[2:]) if goal.startswith(">=") else value <= float(goal[2:])


def calibration(pairs, bins=10):
    """Expected calibration error of stated probabilities."""
    if not pairs:
        return None
    p, ok = np.array([a for a, _ in pairs]), np.array([float(b) for _, b in pairs])
    which = np.minimum((p * bins).astype(int), bins - 1)
    return float(sum(abs(p[which == b].mean() - ok[which == b].mean()) * np.mean(which == b) for b in set(which)))


def load(diagnoses, answers):
    cases = []
    for file in sorted(Path(answers).glob("*/answer.toml")):
        answer = tomllib.loads(file.read_text())
        answer["set"] = file.parent.name
        folder = Path(diagnoses) / file.parent.name
        diagnosis = None
        if (folder / "diagnosis.json").exists():
            try:
                diagnosis = json.loads((folder / "diagnosis.json").read_text())
            except json.JSONDecodeError as e:
                print(f"{folder}/diagnosis.json: {e}")
        seconds = folder / "seconds.txt"
        answer["seconds"] = float(seconds.read_text()) if seconds.exists() else None
        cases.append((answer, diagnosis))
    return cases


def measure(cases, own=None):
    """`own`: by set, the gap that `gap.check` found by itself."""
    t = Tally()
    by = defaultdict(list)
    for a, d in cases:
        by[a["part"]].append((a, d))
    singles = [(a, d) for p in ("singles", "one", "large", "rigs") for a, d in by[p] if a["verdict"] == "named" and len(a["effect"]) == 1]
    shaky = [(a, d) for a, d in singles if a["effect"][0]["size_mde"] >= 2.9 and a["jitter"] > 0]  # the MDE knows no jitter
    seen = [(a, d) for a, d in singles if a["effect"][0]["size_mde"] >= 2.9 and a["jitter"] == 0]
    faint = [(a, d) for a, d in singles if a["effect"][0]["size_mde"] < 1.5]
    clean = [(a, d) for a, d in cases if a["verdict"] == "none"]
    strange = [(a, d) for a, d in cases if a["verdict"] == "unknown"]
    pairs = [(a, d) for a, d in cases if a["verdict"] == "named" and len(a["effect"]) == 2]
    t.share("missing", [d is None for _, d in cases], "<=0", "sets without a diagnosis")
    t.share("name_3x", [right_single(a, d) for a, d in seen], ">=0.95", "right name or class, singles >= 3x MDE")
    t.share("name_3x_jitter", [right_single(a, d) for a, d in shaky], ">=0", "  the same, jittering timestamps")
    t.share("false_alarm", [bool(named(d)) or (d or {}).get("verdict") == "unknown" for _, d in clean], "<=0.02", "any name on none sets")
    t.share("unknown_caught", [(d or {}).get("verdict") == "unknown" for _, d in strange], ">=0.8", "unknown called unknown")
    t.share("listed_unknown", [(d or {}).get("verdict") == "unknown" for _, d in singles], "<=0.05", "listed effect called unknown")
    t.share("pairs_both", [all(touched(e["name"], d) for e in a["effect"]) for a, d in pairs], ">=0.7", "pairs: both named")
    t.share("pairs_one", [any(touched(e["name"], d) for e in a["effect"]) for a, d in pairs], ">=0.95", "pairs: at least one")
    before = [(a, d) for a, d in by["classes"] if a["stage"] == "before"]
    after = [(a, d) for a, d in by["classes"] if a["stage"] == "after" and a["resolves"]]
    single = [(a["effect"][0], bool(named(d)) and len(members(named(d)[0])) == 1) for a, d in before]
    t.share("over_confident", [one for truth, one in single if len(truth.get("class_exact", truth["class"])) > 1], "<=0.02",
            "confident single name inside an exact class")
    t.share("single", [one for _, one in single], ">=0", "  the same, classes that less than 3 sd tell apart")
    wrong = [one and not touched(a["effect"][0]["name"], d) for (a, d), (_, one) in zip(before, single)]
    t.share("single_wrong", wrong, "<=0.02", "  of these, another name than the truth")
    t.share("resolved", [right_single(a, d) and len(members(named(d)[0])) == 1 for a, d in after], ">=0.9",
            "resolved after the experiment")
    t.share("wrong_1x", [bool(named(d)) and not touched(a["effect"][0]["name"], d) for a, d in faint], "<=0.05", "wrong name at 1x MDE")
    errors, covered = [], []
    for a, d in seen:
        truth = a["effect"][0]
        if d is None or not right_single(a, d) or named(d)[0]["name"] != truth["name"]:
            continue
        got = named(d)[0]
        if truth["size_mde"] >= 9.0:
            errors.append(abs(got["value"] - truth["value"]) / max(abs(truth["value"] - truth["off"]), 1e-300))
        if got.get("ci95"):
            covered.append(got["ci95"][0] <= truth["value"] <= got["ci95"][1])
    t.number("parameter_error", errors, "<=0.05", "median relative parameter error at >= 10x")
    t.share("coverage", covered, [0.90, 0.98], "coverage of the 95 % interval")
    closed = [d["gap"]["closed"] for a, d in seen if right_single(a, d) and (d.get("gap") or {}).get("closed") is not None]
    t.number("gap_closed", closed, ">=0.9", "median share of the gap closed on held-out runs")
    # a model that comes out below the noise claims all of the gap, and no more: that is how the scorer's own share ends, too
    pairs = [(min(1.0, d["gap"]["closed"]), (own or {}).get(a["set"], {}).get(d["gap"]["unit"])) for a, d in cases
             if d and (d.get("gap") or {}).get("closed") is not None and d["gap"].get("unit")]
    pairs = [(claimed, found) for claimed, found in pairs if found is not None]
    t.share("gap_overclaimed", [claimed > found + OVERCLAIMED for claimed, found in pairs], "<=0.05",
            "claimed share of the gap beyond what amended.toml closes by itself")
    t.number("gap_apart", [abs(claimed - found) for claimed, found in pairs], "<=0.05", "  difference of the two, median")
    stated = [(e["probability"], touched_truth(a, e)) for a, d in cases for e in named(d)
              if e.get("probability") is not None]
    t.number("calibration", [calibration(stated)] if stated else [], "<=0.05", "calibration error of the stated probability")
    t.rows["calibration"]["n"] = len(stated)
    rates = {rig: [right_single(a, d) for a, d in seen if a["rig"] == rig and a["part"] in ("singles", "rigs")] for rig in ("balance", "hang")}
    for rig, hits in rates.items():
        t.share(f"name_3x_{rig}", hits, ">=0", f"right name, {rig} logs")
    gap = [abs(np.mean(rates["balance"]) - np.mean(rates["hang"]))] if all(rates.values()) else []
    t.number("balance_vs_hang", gap, "<=0.05", "balancing against hanging logs, difference")
    spent = [a["seconds"] for a, _ in cases if a["seconds"] is not None]
    t.number("seconds_median", spent, "<=2", "s of processor time a set, median", np.median)
    t.number("seconds_most", spent, "<=20", "s of processor time a set, most", np.max)
    for axis in ("noise", "mix", "logs", "rig"):
        for value in sorted({a[axis] for a, _ in seen}):
            t.share(f"name_3x_{axis}_{value}", [right_single(a, d) for a, d in seen if a[axis] == value], ">=0.95", f"  of these, {axis} = {value}")
    return t.rows


def touched_truth(answer, effect):
    return any(e["name"] in members(effect) for e in answer.get("effect", []))


def confusion(cases):
    table = defaultdict(Counter)
    for a, d in cases:
        if a["verdict"] == "named" and len(a["effect"]) > 1:
            continue
        truth = {"none": "none", "unknown": a.get("unknown", {}).get("name")}.get(a["verdict"]) or a["effect"][0]["name"]
        if d is None:
            said = "(no diagnosis)"
        elif d.get("verdict") == "unknown":
            said = "unknown"
        elif not named(d):
            said = "none"
        else:
            group = members(named(d)[0])
            said = named(d)[0]["name"] if len(group) == 1 else "{" + ", ".join(sorted(group)) + "}"
            said += f" +{len(named(d)) - 1}" if len(named(d)) > 1 else ""
        table[truth][said] += 1
    return table


def own_gaps(diagnoses, sets, units, cases):
    """What amended.toml closes of each set, computed here."""
    from . import gap  # FMPy is wanted for this alone

    found = {}
    for answer, diagnosis in cases:
        name = answer["set"]
        if diagnosis and (Path(diagnoses) / name / "amended.toml").exists():
            found[name] = gap.check(Path(sets) / name, Path(diagnoses) / name, units, answer) or {}
    return found


def score(diagnoses, answers, out, sets=None, units=None):
    cases = load(diagnoses, answers)
    if not cases:
        print(f"{answers}: no SET/answer.toml inside")
        return 2
    own = own_gaps(diagnoses, sets, units, cases) if sets and units else {}
    rows = measure(cases, own)
    print("| measure | value | n | 95 % | to reach | |\n|---|---|---|---|---|---|")
    for row in rows.values():
        ci = f"{row['ci95'][0]:.3f}-{row['ci95'][1]:.3f}" if "ci95" in row and row["n"] else ""
        value = "-" if row["value"] is None else f"{row['value']:.3f}"
        mark = {None: "", True: "yes", False: "NO"}[row["holds"]]
        print(f"| {row['text']} | {value} | {row['n']} | {ci} | {row['goal']} | {mark} |")
    table = confusion(cases)
    print("\n| truth | n | said |\n|---|---|---|")
    for truth in sorted(table):
        said = ", ".join(f"{k}: {v}" for k, v in table[truth].most_common())
        print(f"| {truth} | {sum(table[truth].values())} | {said} |")
    weak = [a for a, d in cases if a["verdict"] == "named" and len(a["effect"]) == 1 and a["effect"][0]["size_mde"] >= 2.9
            and not right_single(a, d)]
    print("\nWeak at: " + (", ".join(f"{k} ({v})" for k, v in Counter(a["effect"][0]["name"] for a in weak).most_common(12)) or "nothing seen"))
    details = [{"set": a["set"], "part": a["part"], "verdict": a["verdict"], "setting": a["setting"], "truth": a.get("effect", a.get("unknown")),
                "gap": own.get(a["set"]), "said": None if d is None else {"verdict": d.get("verdict"), "effects": named(d), "gap": d.get("gap")}} for a, d in cases]
    Path(out).write_text(json.dumps({"measures": rows, "confusion": {k: dict(v) for k, v in table.items()}, "sets": details}, indent=1))
    return 0
