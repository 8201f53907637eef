"""Results of a few runs, and Debian's Chromium to look at their pages with."""

import csv
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "acroscope"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
# A browser in a container, which asks nobody for anything.
ARGUMENTS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
# Light on a desk, dark in the hand.
LOOKS = [(1280, 900, "light"), (390, 844, "dark")]


def acroscope(*words):
    """What the program prints."""
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=ROOT, env=environment(), capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def environment():
    return {"PATH": "/usr/bin:/bin", "ACROSCOPE_FMUS": str(ROOT / "target" / "fmus")}


@pytest.fixture(scope="session")
def runs(tmp_path_factory):
    """Folders of a run that balances, of one that falls, and of one with as many rows as a page keeps."""
    folder = tmp_path_factory.mktemp("runs")
    acroscope("run", "visual-servo", "--out", folder / "balanced")
    acroscope("run", "visual-servo", "--set", "camera.T_delay=0.05", "--stop", 5, "--out", folder / "fell")
    acroscope("run", "full-state", "--stop", 170, "--out", folder / "long")
    return folder


@pytest.fixture(scope="session")
def browser():
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine: the pages are not looked at")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture
def look(browser):
    """Opens a page; at the end nothing may have been complained about, and nothing asked of any other place."""
    complaints, pages = [], []

    def look(where, width=1280, height=900, scheme="light", **options):
        page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme, **options)
        pages.append(page)
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        address = where if isinstance(where, str) else where.as_uri()
        page.on("request", lambda asked: None if own(asked.url, address) else complaints.append(f"asks for {asked.url}"))
        page.goto(address)
        if options.get("java_script_enabled", True):
            # A page without graphs and tables to narrow has no scripts.
            page.wait_for_function("!document.getElementById('graphs') || document.documentElement.dataset.graphs === 'drawn'")
        return page

    yield look
    for page in pages:
        page.close()
    assert complaints == []


def own(url, address):
    return url == address or url.startswith(("data:", "blob:"))


def rows(folder):
    """The rows of a run by the text of their time."""
    with open(folder / "results.csv", newline="") as file:
        return [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]


def shown(page, graph):
    """What the legend of a graph says, with every digit: numbers in the order of its lines, the time first. Eyes get seven digits."""
    cells = page.locator(".plot").nth(graph).locator(".u-value")
    pairs = cells.evaluate_all("(cells) => cells.map((cell) => [cell.textContent, cell.dataset.exact])")
    values = [float(exact) for _, exact in pairs]
    assert [float(text) for text, _ in pairs] == pytest.approx(values, rel=5e-7, abs=0)
    assert all(len(text.strip("-").replace(".", "").split("e")[0].lstrip("0")) <= 7 for text, _ in pairs), pairs
    return values


def violations(page):
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page).response["violations"]
    return [(rule["id"], [node["html"][:200] for node in rule["nodes"]]) for rule in found]


def middle(page, graph=0):
    over = page.locator(".u-over").nth(graph)
    over.scroll_into_view_if_needed()
    return over.bounding_box()
