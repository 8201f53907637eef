"""Sweeps as others read them: Parquet by pyarrow, cases against single runs, points against scipy, and the files for clusters."""

import csv
import math
import os
import re
import subprocess

import numpy as np
import pyarrow.parquet as parquet
import pytest
from conftest import ROOT
from scipy.stats import qmc

GRID = """
format = 1
scenario = "visual-servo"
stop = 2.5
[grid]
"camera.T_delay" = { from = 0.0, to = 0.06, step = 0.02 }
"camera.omega_cam" = [30, 60]
[scalars]
rms = { signal = "controller.z_desired", minus = "plant.z", reduce = "rms" }
peak = { signal = "plant.tau_applied", reduce = "max" }
low = { signal = "plant.q2", reduce = "min" }
mean = { signal = "plant.q1", reduce = "mean" }
frames = { signal = "camera.frame", reduce = "last" }
fell = { signal = "plant.contact", reduce = "first_true" }
[signals]
variables = ["plant.q*", "camera.valid"]
every = 0.1
"""


def cases(folder):
    return parquet.read_table(folder / "cases")


def by_hand(path):
    """The scalars of GRID from a results.csv, by the words of docs/sweep.md."""
    with path.open() as file:
        rows = list(csv.DictReader(file))
    column = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    over = np.flatnonzero(column["plant.contact"])
    return {
        "rms": math.sqrt(np.mean((column["controller.z_desired"] - column["plant.z"]) ** 2)),
        "peak": column["plant.tau_applied"].max(),
        "low": column["plant.q2"].min(),
        "mean": column["plant.q1"].mean(),
        "frames": column["camera.frame"][-1],
        "fell": column["time"][over[0]] if len(over) else None,
    }, column


@pytest.fixture(scope="module")
def grid(acroscope, tmp_path_factory):
    out = tmp_path_factory.mktemp("grid")
    (out / "study.toml").write_text(GRID)
    acroscope("sweep", out / "study.toml", "--out", out / "set")
    return out


def test_cases_are_the_runs_of_the_command(acroscope, grid, tmp_path):
    rows = cases(grid / "set").to_pylist()
    delays, rates = [0.0, 0.02, 0.04, 0.06], [30.0, 60.0]
    assert [row["case"] for row in rows] == list(range(8))
    assert [(row["camera.T_delay"], row["camera.omega_cam"]) for row in rows] == [(d, r) for d in delays for r in rates]
    signals = parquet.read_table(grid / "set" / "signals")
    for row in (rows[0], rows[3], rows[6]):
        changes = [f"--set={name}={row[name]!r}" for name in ("camera.T_delay", "camera.omega_cam")]
        acroscope("run", "visual-servo", "--stop", "2.5", *changes, "--out", tmp_path / str(row["case"]))
        expected, column = by_hand(tmp_path / str(row["case"]) / "results.csv")
        for name, value in expected.items():
            # Sums of 1501 rows: the order of adding differs.
            assert row[name] == (None if value is None else pytest.approx(value, rel=1e-12)), (row["case"], name)
        mine = signals.filter(np.array(signals["case"]) == row["case"])
        at = np.searchsorted(column["time"], np.array(mine["time"]))
        assert (column["time"][at] == np.array(mine["time"])).all() and len(mine) == 26
        assert (column["plant.q2"][at] == np.array(mine["plant.q2"])).all()
        assert (column["camera.valid"][at] == np.array(mine["camera.valid"])).all()
    assert rows[6]["fell"] is not None and rows[0]["fell"] is None, "0.06 s are 1.8 periods at 30 Hz"


def test_columns_have_the_promised_types(grid):
    schema = cases(grid / "set").schema
    assert schema.names[:3] == ["case", "camera.T_delay", "camera.omega_cam"] and schema.names[-2:] == ["status", "error"]
    types = {"case": "int64", "camera.T_delay": "double", "rms": "double", "fell": "double", "status": "string", "error": "string"}
    assert {name: str(schema.field(name).type) for name in types} == types
    file = parquet.ParquetFile(next((grid / "set" / "cases").glob("part-*.parquet")))
    assert file.schema_arrow.metadata[b"unit:camera.omega_cam"] == b"Hz"
    page = (grid / "set" / "report.html").read_text()
    assert "All 8 cases ran" in page and page.count("<svg") == 6


def test_parts_join_to_the_same_table_whatever_the_threads(acroscope, grid, tmp_path):
    for part in (2, 3, 1):
        acroscope("sweep", grid / "study.toml", "--partition", f"{part}/3", "--jobs", part, "--out", tmp_path)
    assert cases(tmp_path).equals(cases(grid / "set"))
    assert parquet.read_table(tmp_path / "signals").equals(parquet.read_table(grid / "set" / "signals"))
    before = {path: path.stat().st_mtime_ns for path in tmp_path.glob("cases/*")}
    done = acroscope("sweep", grid / "study.toml", "--partition", "2/3", "--out", tmp_path)
    assert "not made again" in done.stderr and before == {path: path.stat().st_mtime_ns for path in tmp_path.glob("cases/*")}
    refused = acroscope("sweep", grid / "study.toml", "--partition", "1/4", "--out", tmp_path, status=2)
    assert "in 3 parts, not 4" in refused.stderr


def test_sobol_points_are_those_of_scipy(acroscope, tmp_path):
    names = ["plant.b_roll", "plant.b_joint", "plant.fc_roll", "plant.fc_joint", "plant.I_rotor", "plant.tau_bias", "plant.slope"]
    ranges = "\n".join(f'"{name}" = {{ from = 0, to = 1 }}' for name in names)
    scalar = 'end = { signal = "plant.q2", reduce = "last" }'
    (tmp_path / "study.toml").write_text(
        f'format = 1\nscenario = "full-state"\nstop = 0.01\n[sobol]\ncount = 500\n{ranges}\n[scalars]\n{scalar}\n'
    )
    acroscope("sweep", tmp_path / "study.toml", "--out", tmp_path / "set")
    table = cases(tmp_path / "set")
    points = np.array([table[name] for name in names]).T
    assert (points == qmc.Sobol(len(names), scramble=False).random(512)[:500]).all()


def test_a_latin_hypercube_is_one_and_lies_better_than_chance(acroscope, tmp_path):
    discrepancy = {}
    for design in ("latin-hypercube", "random"):
        (tmp_path / f"{design}.toml").write_text(
            f'format = 1\nscenario = "full-state"\nstop = 0.01\n[{design}]\ncount = 256\nseed = 11\n'
            '"plant.b_roll" = { from = 0, to = 1 }\n"plant.b_joint" = { from = 0, to = 1 }\n'
            '[scalars]\nend = { signal = "plant.q2", reduce = "last" }\n'
        )
        acroscope("sweep", tmp_path / f"{design}.toml", "--out", tmp_path / design)
        table = cases(tmp_path / design)
        points = np.array([table["plant.b_roll"], table["plant.b_joint"]]).T
        discrepancy[design] = qmc.discrepancy(points)
        if design == "latin-hypercube":
            assert (np.sort((points * 256).astype(int), axis=0) == np.arange(256)[:, None]).all()
    assert discrepancy["latin-hypercube"] < discrepancy["random"]


def test_words_make_a_study(acroscope, tmp_path):
    grid = ["--grid", "camera.T_delay=0:0.06:0.03", "--until", "plant.contact", "--stop", "3"]
    acroscope("sweep", "visual-servo", *grid, "--out", tmp_path)
    rows = cases(tmp_path).to_pylist()
    assert [row["camera.T_delay"] for row in rows] == [0.0, 0.03, 0.06]
    assert rows[0]["plant.contact"] is None and 0 < rows[2]["plant.contact"] < 3


def test_a_refusing_unit_and_a_wrong_word(acroscope, tmp_path):
    # k1 = -5 folds the picture onto itself, and the camera refuses.
    done = acroscope("sweep", "visual-servo", "--grid", "camera.k1=0,-5", "--until", "plant.contact", "--stop", "0.1", "--out", tmp_path)
    rows = cases(tmp_path).to_pylist()
    assert [row["status"] for row in rows] == ["ok", "failed"] and "folds" in rows[1]["error"] and rows[0]["error"] is None
    assert "1 failed" in done.stdout
    for words, said in (
        (["visual-servo"], "--grid"),
        (["visual-servo", "--grid", "camera.k9=0,1", "--until", "plant.contact"], "did you mean"),
        (["visual-servo", "--grid", "camera.T_delay=0:0.05:0.02", "--until", "plant.contact"], "whole steps"),
        (["visual-servo", "--grid", "camera.T_delay=-1,0", "--until", "plant.contact"], "camera.T_delay = -1"),
        (["delay-and-rate", "--partition", "0/4"], "K from 1 to N"),
    ):
        refused = acroscope("sweep", *words, "--out", tmp_path / "none", status=2)
        assert said in refused.stderr and not (tmp_path / "none").exists(), refused.stderr


def test_the_files_for_clusters_work(grid, tmp_path):
    """The Slurm script as Slurm would call it, and the command of the Kubernetes job."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "acroscope").symlink_to(ROOT / "target" / "release" / "acroscope")
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    folder = ROOT / "examples" / "cluster"
    for task in (1, 2):
        slurm = {"SLURM_ARRAY_TASK_ID": str(task), "SLURM_ARRAY_TASK_COUNT": "2", "PATH": path}
        words = ["bash", folder / "sweep.slurm", grid / "study.toml", tmp_path / "slurm"]
        subprocess.run(words, env=os.environ | slurm, check=True)
    job = (folder / "sweep-job.yaml").read_text()
    command = re.search(r"args: \['(.*)'\]", job)[1]
    assert re.search(r"completions: (\d+)", job)[1] == re.search(r'PARTS\s+value: "(\d+)"', job)[1]
    for index in (0, 1):
        pod = {"JOB_COMPLETION_INDEX": str(index), "PARTS": "2", "STUDY": str(grid / "study.toml"), "PATH": path}
        subprocess.run(["/bin/sh", "-c", command], env=os.environ | pod | {"OUT": str(tmp_path / "pods")}, check=True)
    for name in ("slurm", "pods"):
        assert cases(tmp_path / name).equals(cases(grid / "set")) and (tmp_path / name / "report.html").is_file()


def test_files_for_clusters_cut_any_command(tmp_path):
    """The Slurm script and the command of the Kubernetes job for whatever takes `--partition`, by the paper's studies."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "acroscope").symlink_to(ROOT / "target" / "release" / "acroscope")
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    folder = ROOT / "examples" / "cluster"
    whole = ["acroscope", "--quiet", "reproduce", "tables-1-2", "table-3"]
    subprocess.run([*whole, "--out", tmp_path / "whole"], env=os.environ | {"PATH": path}, check=True)
    job = (folder / "parts-job.yaml").read_text()
    command = re.search(r"args: \['(.*)'\]", job)[1]
    assert re.search(r"completions: (\d+)", job)[1] == re.search(r'PARTS\s+value: "(\d+)"', job)[1]
    for part in (1, 2):
        slurm = {"SLURM_ARRAY_TASK_ID": str(part), "SLURM_ARRAY_TASK_COUNT": "2", "PATH": path}
        words = ["bash", folder / "parts.slurm", *whole, "--out", tmp_path / "slurm"]
        subprocess.run(words, env=os.environ | slurm, check=True)
        pod = {"JOB_COMPLETION_INDEX": str(part - 1), "PARTS": "2", "PATH": path}
        pod["COMMAND"] = " ".join([*whole, "--out", str(tmp_path / "pods")])
        subprocess.run(["/bin/sh", "-c", command], env=os.environ | pod, check=True)
    claims = (tmp_path / "whole" / "claims.json").read_bytes()
    for name in ("slurm", "pods"):
        assert (tmp_path / name / "claims.json").read_bytes() == claims
