"""The command line as a user types it: results, messages, exit statuses."""

import csv
import json
import signal
import subprocess
import time

import numpy as np
import pytest
from conftest import ROOT


def read(path):
    with path.open() as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


@pytest.fixture(scope="module")
def figures(acroscope, tmp_path_factory):
    out = tmp_path_factory.mktemp("figures")
    for scenario in ("visual-servo", "full-state"):
        acroscope("run", scenario, "--out", out / scenario)
    return {scenario: read(out / scenario / "results.csv") for scenario in ("visual-servo", "full-state")} | {"out": out}


def test_the_main_job_balances_and_tracks(figures):
    for scenario in ("visual-servo", "full-state"):
        results = figures[scenario]
        z, wanted, t = results["plant.z"], results["controller.z_desired"], results["time"]
        assert t[-1] == 30.0 and len(t) == 18001 and not results["plant.contact"].any()
        assert wanted.max() == pytest.approx(0.5, abs=1e-12) and wanted[-1] == 0.0  # the ramp rounds
        # C37: end offsets < .005, rms of the error .036 with these poles and 0.05/s ramps, 20 %.
        assert abs(z[-1]) < 0.005 and abs(z[(t > 14.5) & (t < 15)] - 0.5).max() < 0.01
        assert np.sqrt(np.mean((wanted - z) ** 2)) == pytest.approx(0.036, rel=0.3)


def test_torque_chatters_more_with_vision(figures):
    steps = {name: np.diff(figures[name]["controller.tau"][::20]) for name in ("visual-servo", "full-state")}
    rms = {name: np.sqrt(np.mean(step[30:] ** 2)) for name, step in steps.items()}
    assert rms["visual-servo"] > 10 * rms["full-state"]  # C39: 13 to 27 times


def test_the_report_shows_the_four_graphs_and_a_frame(figures):
    page = (figures["out"] / "visual-servo" / "report.html").read_text()
    for title in ("Tracking along the manifold", "State", "Torque", "Tracking error"):
        assert title in page
    assert page.count("<svg") >= 5 and "data:image/png;base64," in page


def test_resolved_scenario_gives_the_same_bytes(acroscope, tmp_path):
    acroscope("run", "visual-servo", "--stop", "1", "--set", "camera.sigma=9", "--out", tmp_path / "a")
    acroscope("run", tmp_path / "a" / "resolved.toml", "--out", tmp_path / "b")
    assert (tmp_path / "a" / "results.csv").read_bytes() == (tmp_path / "b" / "results.csv").read_bytes()


@pytest.mark.parametrize(
    "arguments,said",
    [
        (["nope"], "visual-servo, full-state"),
        (["visual-servo", "--set", "camera.k9=1"], "k9"),
        (["visual-servo", "--set", "camera.k1=abc"], "camera.k1 = abc"),
        (["visual-servo", "--set", "camera.k1"], "UNIT.VARIABLE=VALUE"),
        (["visual-servo", "--set", "camera.T_delay=-1"], "camera.T_delay = -1"),
        (["visual-servo", "--set", "camera.k1=-5"], "folds"),
        (["visual-servo", "--stop", "soon"], "soon"),
    ],
)
def test_wrong_input_is_named_and_exits_with_2(acroscope, tmp_path, arguments, said):
    done = acroscope("run", *arguments, "--out", tmp_path, status=2)
    assert said in done.stderr and "panicked" not in done.stderr


def test_a_killed_run_leaves_a_readable_file(tmp_path):
    program = ROOT / "target" / "release" / "acroscope"
    command = [program, "run", "visual-servo", "--stop", "100000", "--out", tmp_path]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    path = tmp_path / "results.csv"
    deadline = time.time() + 60
    while time.time() < deadline and not (path.exists() and path.stat().st_size > 3_000_000):
        time.sleep(0.05)
    run.send_signal(signal.SIGKILL)
    run.wait()
    lines = path.read_text().splitlines()
    whole = [line for line in lines[1:] if line.count(",") == lines[0].count(",")]
    assert len(whole) >= len(lines) - 2, "at most the last line is cut"
    assert len(whole) > 600, "at least a simulated second is there"


def test_a_rehearsal_finds_what_was_hidden(acroscope, tmp_path):
    """Hide radial distortion, run, record, diagnose."""
    for run in (1, 2):
        hidden = ["--set", "camera.k1=0.03", "--set", f"camera.seed={run}", "--set", f"plant.q2_0=0.0{run}"]
        acroscope("run", "visual-servo", "--stop", "12", *hidden, "--out", tmp_path / f"run-{run}")
    acroscope("record", tmp_path / "run-1", tmp_path / "run-2", "--out", tmp_path / "set")
    acroscope("diagnose", tmp_path / "set", "--out", tmp_path / "diagnosis")
    diagnosis = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text())
    assert diagnosis["verdict"] in ("named", "ambiguous")
    assert [effect["name"] for effect in diagnosis["effects"]] == ["camera.k1"]
    assert diagnosis["effects"][0]["value"] == pytest.approx(0.03, rel=0.05)
    acroscope("run", tmp_path / "diagnosis" / "amended.toml", "--stop", "1", "--out", tmp_path / "amended")


def test_a_resumed_run_that_is_refused_keeps_what_is_there(acroscope, tmp_path):
    out = tmp_path / "run"
    acroscope("run", "full-state", "--stop", "1", "--checkpoint", "0.4", "--out", out)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert {"report.html", "summary.json", "checkpoint.bin"} <= set(before)
    command = [ROOT / "target" / "release" / "acroscope", "run", "full-state", "--set", "plant.b_joint=0.1", "--stop", "1", "--resume"]
    refused = subprocess.run([*command, "--out", out], capture_output=True, text=True)
    assert refused.returncode == 2 and "this one differs" in refused.stderr
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    acroscope("run", "full-state", "--stop", "1", "--checkpoint", "0.4", "--resume", "--out", out)
    assert (out / "results.csv").read_bytes() == before["results.csv"]


def test_real_time_keeps_to_the_clock_and_changes_no_row(acroscope, tmp_path):
    acroscope("run", "full-state", "--stop", "0.5", "--out", tmp_path / "fast")
    began = time.monotonic()
    told = acroscope("run", "full-state", "--stop", "0.5", "--real-time", "2", "--out", tmp_path / "slow")
    assert time.monotonic() - began >= 0.25  # no point comes before it is due, however busy the machine is
    assert (tmp_path / "fast" / "results.csv").read_bytes() == (tmp_path / "slow" / "results.csv").read_bytes()
    assert (tmp_path / "fast" / "report.html").read_bytes() != b"" and not (tmp_path / "fast" / "pacing.json").exists()
    pacing = json.loads((tmp_path / "slow" / "pacing.json").read_text())
    assert pacing["factor"] == 2 and pacing["points"] == 300
    assert 0 <= pacing["late_mean"] <= pacing["late_most"] and 0 <= pacing["missed"] <= 300
    assert "real time x 2: 300 points" in told.stdout
