"""Several methods on the same sets, by the measures of score.py: the first named is the one that has to stand above."""

from pathlib import Path

from . import score

GENEROUS = "  the same, were any member of the true class (wide) right"
LENIENT = "  the same, were names after the first forgiven, too"


def cases_of(diagnoses, answers):
    """DIAGNOSES may hold SET/... or PART/SET/...; answers lie in several folders."""
    root, cases = Path(diagnoses), []
    places = [root, *sorted(p for p in root.iterdir() if any(p.glob("*/diagnosis.json")))]
    for folder in answers:
        found = [score.load(place, folder) for place in places]
        cases += [max(rows, key=lambda r: r[1] is not None) for rows in zip(*found)]
    return cases


def _seen(cases):
    """What name_3x is about."""
    return [(a, d) for a, d in cases if a["part"] in ("singles", "one", "large", "rigs") and a["verdict"] == "named"
            and len(a["effect"]) == 1 and a["effect"][0]["size_mde"] >= 2.9 and a["jitter"] == 0]


def generous(answer, diagnosis, more=0):
    """The first name lies in the truth's wide class, and at most `more` follow: all that a method without classes can do."""
    found, truth = score.named(diagnosis), answer["effect"][0]
    allowed = {truth["name"], *truth.get("class", []), *truth.get("class_wide", [])}
    return 0 < len(found) <= 1 + more and diagnosis.get("verdict") != "unknown" and found[0]["name"] in allowed


def table(by_method):
    """{measure: {method: row of score.measure}}, with what a kinder judge would say behind name_3x."""
    rows = {}
    for method, cases in by_method.items():
        for key, row in score.measure(cases).items():
            rows.setdefault(key, {})[method] = row
            if key == "name_3x":
                for text, more in ((GENEROUS, 0), (LENIENT, 99)):
                    hits = [generous(a, d, more) for a, d in _seen(cases)]
                    value = sum(hits) / len(hits) if hits else None
                    rows.setdefault(text, {})[method] = {"text": text, "value": value, "n": len(hits), "goal": ""}
    return rows


def lead(first, other):
    """(points by which the first is above, sets only the first names, sets only the other names) at >= 3x MDE."""
    a, b = ([score.right_single(*case) for case in _seen(cases)] for cases in (first, other))
    if not a:
        return None
    return 100.0 * (sum(a) - sum(b)) / len(a), sum(x and not y for x, y in zip(a, b)), sum(y and not x for x, y in zip(a, b))


def compare(methods, answers):
    by_method = {}
    for text in methods:
        name, _, folder = text.partition("=")
        if not folder or not Path(folder).is_dir():
            print(f"{text}: expected NAME=DIAGNOSES with a folder, e.g. ours=out/ours")
            return 2
        by_method[name] = cases_of(folder, answers)
    first, *others = by_method
    if not by_method[first]:
        print(f"{', '.join(answers)}: no SET/answer.toml inside")
        return 2
    print(f"| measure | n | {' | '.join(by_method)} | to reach |\n|---|---|{'---|' * len(by_method)}---|")
    for rows in table(by_method).values():
        some = next(iter(rows.values()))
        counts = sorted({r["n"] for r in rows.values()})
        values = ["-" if m not in rows or rows[m]["value"] is None else f"{rows[m]['value']:.3f}" for m in by_method]
        print(f"| {some['text']} | {'/'.join(map(str, counts))} | {' | '.join(values)} | {some['goal']} |")
    for name in others:
        got = lead(by_method[first], by_method[name])
        if got:
            print(f"\nname_3x: {first} is {got[0]:+.1f} points from {name} (to reach +20); "
                  f"only {first} right in {got[1]} sets, only {name} in {got[2]}")
    return 0
