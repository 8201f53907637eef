"""Judges diagnoses (`diagnosis.json`) by the answers."""

import json
from pathlib import Path

import numpy as np


def score(diagnoses, answers, sets=None):
    """Rows and measures."""
    rows = [judged(answer, diagnoses, sets) for answer in sorted(Path(answers).glob("*.json"))]
    return {"rows": rows, "measures": measures(rows)}


def judged(path, diagnoses, sets):
    answer = json.loads(path.read_text())
    folder = Path(diagnoses) / path.stem
    row = {"set": path.stem, "machine": answer["machine"], "case": answer["case"], "wanted": answer["verdict"], "class": answer["class"]}
    call = folder / "call.json"
    if call.is_file():
        row["seconds"] = json.loads(call.read_text())["seconds"]
    file = folder / "diagnosis.json"
    if not file.is_file():
        return row | {"said": "no diagnosis", "names": [], "right": False}
    said = json.loads(file.read_text())
    named = said.get("effects") or []
    row |= {"said": said["verdict"], "names": [effect["name"] for effect in named], "shown": answer.get("shown")}
    row["right"] = right(answer, said, named)
    row["value_off"] = value_off(answer, named)
    row["closed"] = (said.get("gap") or {}).get("closed")
    if answer.get("traces"):
        row["trace"] = followed(answer["traces"], said.get("unknown") or {})
    if sets and answer["verdict"] in ("named", "ambiguous") and (folder / "amended.toml").is_file():
        from .replay import closed

        row["replayed"] = closed(Path(sets) / path.stem, folder / "amended.toml", answer)
    return row


def right(answer, said, named):
    """The verdict and, where there is one, the name: the only effect, itself or in a class that stays within the true one."""
    wanted = answer["verdict"]
    if wanted in ("none", "unknown"):
        return said["verdict"] == wanted
    if said["verdict"] not in ("named", "ambiguous") or len(named) != 1:
        return False
    truth, given = answer["effects"][0]["name"], named[0].get("class") or [named[0]["name"]]
    return truth in given and (len(given) == 1 or set(given) <= set(answer["class"])) or named[0]["name"] in answer["class"]


def value_off(answer, named):
    """How many half widths of its interval a found value is off."""
    for effect in named:
        if answer["effects"] and effect["name"] == answer["effects"][0]["name"]:
            half = 0.5 * (effect["ci95"][1] - effect["ci95"][0])
            return round(abs(effect["value"] - answer["effects"][0]["value"]) / half, 2) if half > 0 else None
    return None


def followed(traces, unknown):
    """Correlation of the smoothed course with the true one, best run and sign."""
    trace = unknown.get("trace")
    if not trace:
        return None
    at, values = np.array(trace, float).T
    found = []
    for truth in traces:
        times, true = np.array(truth).T
        shift = at[0] - times[0]
        inside = (at >= times[0] + shift) & (at <= times[-1] + shift)
        other = np.interp(at[inside] - shift, times, true)
        if inside.sum() > 10 and np.std(other) > 0 and np.std(values[inside]) > 0:
            found.append(abs(np.corrcoef(values[inside], other)[0, 1]))
    return round(float(max(found)), 2) if found else None


def share(rows, key="right"):
    values = [bool(row[key]) for row in rows]
    return {"value": round(float(np.mean(values)), 3) if values else None, "count": len(values)}


# Twice what a search could see at best: an effect that shows less may be passed over.
SHOWN = 12.0


def measures(rows):
    """What the issue asks for. Effects that hardly show count for nothing but time."""
    listed = [row for row in rows if row["wanted"] in ("named", "ambiguous") and row.get("shown", SHOWN) >= SHOWN]
    off = [row["value_off"] for row in listed if row.get("value_off") is not None]
    replayed = [row["replayed"] for row in listed if row.get("replayed") is not None]
    return {
        "name": share(listed),
        "none": share([row for row in rows if row["wanted"] == "none"]),
        "unknown": share([row for row in rows if row["wanted"] == "unknown"]),
        "cover": {"value": round(float(np.mean([o <= 1 for o in off])), 3) if off else None, "count": len(off)},
        "gap_closed": {"value": round(float(np.median(replayed)), 3) if replayed else None, "count": len(replayed)},
        "trace": share([row | {"good": (row.get("trace") or 0) > 0.7} for row in rows if row["case"] == "door"], "good"),
    }


def text(result):
    lines = [f"{'set':<12}{'case':<20}{'wanted':<11}{'said':<14}{'ok':<4}names"]
    for row in result["rows"]:
        tail = ", ".join(row["names"]) + (f"   class {row['class']}" if not row["right"] and row["class"] else "")
        lines.append(f"{row['set']:<12}{row['case']:<20}{row['wanted']:<11}{row['said']:<14}{'+' if row['right'] else '-':<4}{tail}")
    lines += [f"{name}: {value['value']} of {value['count']}" for name, value in result["measures"].items()]
    return "\n".join(lines)
