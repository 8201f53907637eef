"""The page of a check, in a real browser."""

import json
import subprocess
import zipfile

import pytest
from conftest import LOOKS, PROGRAM, ROOT, environment, violations


def checked(unit, out):
    words = [PROGRAM, "check", unit, "--json", "--out", out]
    return json.loads(subprocess.run(words, env=environment(), capture_output=True, text=True, timeout=120).stdout)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Pages and findings of a sound unit and of one whose description was damaged."""
    folder = tmp_path_factory.mktemp("check")
    sound = ROOT / "target" / "fmus" / "signal_effects.fmu"
    broken = folder / "broken.fmu"
    with zipfile.ZipFile(sound) as whole, zipfile.ZipFile(broken, "w") as damaged:
        for name in whole.namelist():
            text = whole.read(name)
            if name == "modelDescription.xml":
                text = text.replace(b'name="delay"', b'name="gain"').replace(b'causality="output"', b'causality="outputs"')
            damaged.writestr(name, text)
    return {name: (folder / name / "report.html", checked(unit, folder / name)) for name, unit in [("sound", sound), ("broken", broken)]}


@pytest.mark.parametrize("width, height, scheme", LOOKS)
@pytest.mark.parametrize("name", ["sound", "broken"])
def test_every_page_fits_and_can_be_read(pages, look, name, width, height, scheme):
    page = look(pages[name][0], width, height, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    assert violations(page) == []


def test_the_verdict_and_the_rows_are_those_of_the_file(pages, look):
    path, findings = pages["broken"]
    errors = [finding for finding in findings if finding["severity"] == "error"]
    assert errors
    page = look(path)
    assert "breaks the standard" in page.locator(".verdict .words").inner_text()
    rows = page.locator(".filtered tbody tr")
    assert rows.count() == len(findings) and rows.first.get_attribute("data-marks").startswith("error")
    page.get_by_role("searchbox").fill(errors[0]["text"].split("\n")[0][:40])
    assert errors[0]["text"][:40] in page.locator(".filtered tbody tr:visible").first.inner_text()
    assert "Nothing speaks against" in look(pages["sound"][0]).locator(".verdict .words").inner_text()


def test_rules_that_never_ran_are_not_those_that_found_nothing(pages, look):
    """The description that is not true keeps the unit from being opened: nothing is known of what it would do."""
    text = look(pages["broken"][0]).locator("body").inner_text()
    found, left_out = text.split("Rules that were not looked at")
    silent = found.split("Rules that found nothing")[1]
    assert "crash" not in silent and "leak" not in silent
    assert "crash" in left_out and "because the unit can't be opened" in left_out
    assert "Rules that were not looked at" not in look(pages["sound"][0]).locator("body").inner_text()
