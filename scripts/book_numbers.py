"""Sources of the book's numbers: each runs the program (or reads what a benchmark wrote) and gives {name: text}. See scripts/book.py."""

import functools
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import book_camera
from scipy.stats import chi2

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "target" / "release" / "acroscope"


def acroscope(folder, *words):
    """What the program prints, run in a folder that has the examples."""
    if not (Path(folder) / "examples").exists():
        (Path(folder) / "examples").symlink_to(ROOT / "examples")
    environment = os.environ | {"ACROSCOPE_FMUS": str(ROOT / "target" / "fmus")}
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"acroscope {' '.join(map(str, words))} ends with {done.returncode}:\n{done.stderr}")
    return done.stdout


def in_folder(source):
    """A source that needs an empty folder to work in."""

    @functools.wraps(source)
    def run(_docs):
        with tempfile.TemporaryDirectory() as folder:
            return source(Path(folder))

    return run


def console(command, lines):
    return f"\n```console\n$ cargo {command}\n" + "\n".join(lines) + "\n...\n```\n"


@in_folder
def hidden_effect(folder):
    """The diagnosis of examples/hidden-effect."""
    command = "diagnose examples/hidden-effect"
    said = acroscope(folder, *command.split()).splitlines()
    found = json.loads((folder / "out" / "diagnose-hidden-effect" / "diagnosis.json").read_text())
    gap = found["gap"]
    looks = re.search(r"The residual looks most like (.*?) \(in standard deviations", " ".join(found["story"])).group(1)
    return {
        "answer": console(f"acroscope {command}", said[: next(i for i, line in enumerate(said) if line.startswith("the gap")) + 1]),
        "looks-like": re.sub(r"([a-z]+\.\w+)", r"`\1`", looks),
        "before": f"{gap['before']:.3f} {gap['unit']}",
        "after": f"{gap['after']:.4f}",
        "floor": f"{gap['floor']:.4f}",
        "closed": f"{100 * min(gap['closed'], 1.0):.0f} %",  # as pages tell it
        "least": "{:.1g}".format(found["minimum_detectable"]["plant.b_joint"]),
    }


@in_folder
def late(folder):
    """The paper's loop with a camera that is too late."""
    acroscope(folder, "run", "visual-servo", "--set", "camera.T_delay=0.05", "--out", "late")
    told = json.loads((folder / "late" / "summary.json").read_text())
    told["verdict"]["figures"] = [one for one in told["verdict"]["figures"] if one["label"] == "peak torque"]
    told["units"] = {"plant.q1": told["units"]["plant.q1"]}
    made = told["provenance"]
    # Of one commit, one build: what stands here must not change with every commit.
    made["program"]["commit"] = "0123456789ab"
    made["inputs"][0]["sha256"] = "…"
    made["units"] = [made["units"][0] | {"guid": "…", "tool": "…", "sha256": "…"}]
    made["command"] = "acroscope run visual-servo --set camera.T_delay=0.05"
    return {"summary": "\n```json\n" + json.dumps(told, indent=2, ensure_ascii=False) + "\n```\n", "falls": f"{told['failed_at']:.1f} s"}


@in_folder
def container(folder):
    """The paper's loop as one unit."""
    command = "acroscope container visual-servo -o visual_servo.fmu"
    said = acroscope(folder, *command.split()[1:]).splitlines()
    return {"counts": f"\n```console\n$ {command}\n" + "\n".join(said) + "\n```\n"}


@in_folder
def claims(folder):
    """Every statement of the paper."""
    acroscope(folder, "--quiet", "reproduce", "--out", "all")
    rows = json.loads((folder / "all" / "claims.json").read_text())
    by_id = {row["id"]: row for row in rows}
    stated = sorted((row for row in rows if re.fullmatch(r"C\d+", row["id"])), key=lambda row: int(row["id"][1:]))
    # What the paper lays down is no statement that could fail: `acroscope reproduce` counts it apart, and so does this page.
    counted = [row for row in stated if row["kind"] == "claim"]
    taken = {(False, True): "holds", (False, False): "**does not hold**", (True, True): "laid down", (True, False): "**does not hold**"}
    lines = ["| id | what is stated | paper | ours | |", "|---|---|---|---|---|"]
    cell = lambda text: text.replace("|", "\\|").replace("\n", " ")  # noqa: E731
    for row in stated:
        words = " | ".join(cell(row[key]) for key in ("id", "quantity", "paper", "ours"))
        lines.append(f"| {words} | {taken[row['kind'] == 'definition', row['holds']]} |")
    poles = re.search(r"±([\d.]+)", by_id["C11"]["ours"]).group(1)
    half = re.search(r"q2 = ([\d.]+)", by_id["C12"]["ours"]).group(1)
    pixels = re.match(r"[\d.]+", by_id["C15"]["ours"]).group(0)
    return {
        "table": "\n" + "\n".join(lines) + "\n",
        "statements": len(counted),
        "hold": sum(row["holds"] for row in counted),
        "laid-down": len(stated) - len(counted),
        "fastest-pole": f"{float(poles):.0f} 1/s",
        "q2-of-one-half": half,
        "pixels": f"{float(pixels):.0f} px",
    }


@in_folder
def motor(folder):
    """docs/your-fmu.md: import and diagnosis of examples/motor."""
    sys.path.insert(0, str(ROOT / "tests"))
    from hidden_any.machines import ALL

    unit = ALL["motor"].build(ALL["motor"], folder)
    logs = [f"examples/motor/logs/motor-{run}.csv" for run in (1, 2, 3)]
    acroscope(folder, "import", *logs, "--fmu", unit, "--out", "out/motor")
    channels = (folder / "out" / "motor" / "dataset.toml").read_text().split("[[channel]]\n")
    guess = next(one for one in channels if '"motor.phi"' in one).split("\n\n")[0].strip()
    command = "acroscope diagnose out/motor --out out/motor-diagnosis"
    said = acroscope(folder, *command.split()[1:]).splitlines()
    answer = said[: next(i for i, line in enumerate(said) if line.startswith("the gap")) + 1]
    return {"guess": f"\n```toml\n[[channel]]\n{guess}\n```\n", "answer": console(command, answer)}


def chance(_docs):
    """What the best of so many candidates gains by chance in one of 1/false_alarm searches: chi squared, each candidate at its share of that."""
    source = (ROOT / "diagnosis" / "src" / "search" / "policy.rs").read_text()
    rate, twice = (float(re.search(rf"{name}: ([\d.e-]+)", source).group(1)) for name in ("false_alarm", "integrators"))
    least = lambda count, freedom: chi2.isf(rate / count, freedom)  # noqa: E731
    names = {f"of-{count}": f"{least(count, 1):.1f}" for count in (5, 20, 60)}
    return names | {"one-in": f"{1 / rate:,.0f}".replace(",", " "), "equations": f"{twice * least(3, 2):.1f}"}


def speed(_docs):
    """docs/speed.md, which scripts/bench.sh writes: the master beside a plain C loop."""
    ratios = []
    for line in (ROOT / "docs" / "speed.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) > 5 and cells[3] == "C loop" and cells[1].startswith(("step of", "point of")):
            size, words = cells[5].split(" ", 1)
            ratios.append(1 / float(size) if "faster" in words else float(size))
    if len(ratios) < 6:
        raise SystemExit(f"docs/speed.md has {len(ratios)} rows beside a C loop: has scripts/bench.sh written it?")
    return {"least": f"{min(ratios):.2f}", "most": f"{max(ratios):.2f}", "rows": len(ratios)}


def lines(_docs):
    """Lines of Rust, tests left out, to a hundred."""
    files = [file for file in (ROOT / "orchestrator" / "src" / "fmu").rglob("*.rs") if "tests" not in file.parts and file.stem != "tests"]
    count = round(sum(len(file.read_text().splitlines()) for file in files), -2)
    return {"importer": f"{count:,}".replace(",", " ")}


def camera(docs):
    """docs/camera.md."""
    return {"effects": book_camera.make(docs)}


SOURCES = {
    "camera": camera,
    "chance": chance,
    "claims": claims,
    "container": container,
    "hidden-effect": hidden_effect,
    "late-camera": late,
    "lines": lines,
    "motor": motor,
    "speed": speed,
}
