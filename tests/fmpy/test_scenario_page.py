"""docs/scenario.md: its blocks are one scenario, and it runs."""

import re

from conftest import ROOT


def test_the_blocks_of_the_page_are_a_scenario_that_runs(acroscope, tmp_path):
    page = (ROOT / "docs" / "scenario.md").read_text()
    blocks = re.findall(r"```toml\n(.*?)```", page, re.S)
    assert len(blocks) == 2, "a block that this test doesn't know"
    file = tmp_path / "page.toml"
    file.write_text("\n".join(blocks))
    acroscope("run", file, "--stop", "0.2", "--out", tmp_path / "out")
    assert (tmp_path / "out" / "report.html").exists() and (tmp_path / "out" / "frames").is_dir()
