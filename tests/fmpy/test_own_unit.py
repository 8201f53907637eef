"""docs/own-unit.md as a reader follows it: its files into an empty folder, its commands, its Python."""

import json
import os
import re
import shutil
import subprocess
import sys

from conftest import ROOT


def test_the_page_leads_from_an_empty_folder_to_fmpy(tmp_path):
    page = (ROOT / "docs" / "own-unit.md").read_text()
    blocks = {language: re.findall(rf"```{language}\n(.*?)```", page, re.S) for language in ("toml", "rust", "python", "console")}
    assert [len(blocks[language]) for language in ("toml", "rust", "python")] == [1, 1, 2]
    commands = [line.removeprefix("$ ") for block in blocks["console"] for line in block.splitlines()]
    assert commands[:2] == ["cargo install --path ../acroscope/cargo-fmi2", "cargo fmi2 pack"] and len(commands) == 4

    (tmp_path / "src").mkdir()
    (tmp_path / "Cargo.toml").write_text(blocks["toml"][0].replace("../acroscope", str(ROOT)))
    (tmp_path / "src" / "lib.rs").write_text(blocks["rust"][0])
    shutil.copy(ROOT / "Cargo.lock", tmp_path)  # the versions that are here already
    run = {"cwd": tmp_path, "check": True, "capture_output": True, "text": True}
    build = ["cargo", "build", "--quiet", "--release", "--package", "cargo-fmi2", "--manifest-path", ROOT / "Cargo.toml"]
    subprocess.run(build, **run)
    installed = ROOT / "target" / "release" / "cargo-fmi2"  # what `cargo install` would put into the path
    folders = os.environ | {"PATH": f"{installed.parent}{os.pathsep}{os.environ['PATH']}", "CARGO_NET_OFFLINE": "true"}
    packed = subprocess.run(commands[1].split(), env=folders, **run)
    assert packed.stdout.strip().endswith("target/fmus/heater.fmu")

    done = subprocess.run([sys.executable, "-c", blocks["python"][0]], **run)
    # 343.15 - 50 exp(-2/500 * 600)
    assert abs(float(done.stdout) - 338.6141) < 1e-3
    described = subprocess.run(["cargo", "fmi2", "describe"], env=folders, **run).stdout
    assert 'modelIdentifier="heater"' in described and 'name="T_out"' in described

    # the last section: logs of scipy's, which the unit is held against
    subprocess.run([sys.executable, "-c", blocks["python"][1]], **run)
    program = ROOT / "target" / "release"
    folders["PATH"] = f"{program}{os.pathsep}{folders['PATH']}"
    for command in commands[2:]:
        subprocess.run(command.split(), env=folders, **run)
    found = json.loads((tmp_path / "found" / "diagnosis.json").read_text())
    assert found["verdict"] == "named" and [effect["name"] for effect in found["effects"]] == ["heater.G"]
    # within 1 %: noise of 0.05 K in 1803 rows says it to 0.1 %
    assert abs(found["effects"][0]["value"] - 2.6) < 0.026
