"""The pages of a reproduction, in a real browser."""

import json
import random

import numpy as np
import pytest
from conftest import LOOKS, acroscope, middle, shown, violations


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    out = tmp_path_factory.mktemp("reproduce")
    # Quick ones: fields with sliders, graphs over q2, a statement that does not hold.
    acroscope("reproduce", "C1", "C17", "C10", "C9", "--out", out)
    return out


@pytest.fixture(scope="module")
def claims(site):
    return json.loads((site / "claims.json").read_text())


def pages(site):
    return [site / "index.html", *sorted((site / "studies").glob("*.html"))]


@pytest.mark.parametrize("width, height, scheme", LOOKS)
def test_every_page_fits_and_can_be_read(site, look, width, height, scheme):
    assert len(pages(site)) == 5
    for path in pages(site):
        page = look(path, width, height, scheme)
        assert page.evaluate("document.documentElement.scrollWidth") <= width, f"{path.name} scrolls sideways"
        assert violations(page) == [], path.name
        assert page.locator(".verdict").bounding_box()["y"] < page.locator("table, figure, article").first.bounding_box()["y"]


def test_what_fails_comes_first_and_the_filter_counts_what_the_file_says(site, claims, look):
    page = look(site / "index.html")
    rows = page.locator(".filtered tbody tr")
    failing = [claim["id"] for claim in claims if not claim["holds"]]
    assert failing and rows.count() == len(claims)
    first = [rows.nth(number).get_attribute("id") for number in range(len(failing))]
    assert sorted(first) == sorted(failing)
    page.get_by_role("button", name=f"does not hold ({len(failing)})").click()
    assert page.locator(".filtered tbody tr:visible").count() == len(failing)
    page.get_by_role("button", name=f"does not hold ({len(failing)})").click()
    page.get_by_role("searchbox").fill("mirrors figure 5")
    assert [row.get_attribute("id") for row in page.locator(".filtered tbody tr:visible").all()] == ["C2"]
    assert page.get_by_role("status").first.inner_text() == f"1 of {len(claims)} rows"


def test_every_statement_leads_to_its_page_and_its_figure(site, claims, look):
    page = look(site / "index.html")
    addresses = page.evaluate("[...document.querySelectorAll('.filtered td a')].map((a) => a.getAttribute('href'))")
    assert len(addresses) == len(claims)
    for address in addresses:
        path, anchor = address.split("#")
        assert f'id="{anchor}"' in (site / path).read_text(), address
    for path in (site / "studies").glob("*.html"):
        text = path.read_text()
        page = look(path)
        for anchor in page.evaluate("[...document.querySelectorAll('a[href^=\"#\"]')].map((a) => a.getAttribute('href').slice(1))"):
            assert f'id="{anchor}"' in text, f"{path.name}: {anchor}"


def test_the_index_has_every_figure_and_table_and_opens_them(site, look):
    page = look(site / "index.html")
    stored = [json.loads(path.read_text())["outcome"] for path in (site / "studies").glob("*.json")]
    assert page.locator("details.study figure svg").count() == sum(len(outcome["figures"]) for outcome in stored) >= 7
    assert page.locator("details.study table").count() == sum(len(outcome["tables"]) for outcome in stored)
    assert not page.locator("details.study figure").first.is_visible()
    page.locator("details.study summary").first.click()
    assert page.locator("details.study figure").first.is_visible()


def test_a_study_says_what_the_paper_shows_and_its_graph_has_the_values(site, look):
    page = look(next((site / "studies").glob("*figure-12.html")))
    assert "Error in visual state estimation with no distortions." in page.locator(".printed").inner_text()
    outcome = json.loads(next((site / "studies").glob("*figure-12.json")).read_text())["outcome"]
    lines = [dict(map(tuple, line["points"])) for line in outcome["figures"][0]["graph"]["lines"]]
    rng = random.Random(27)
    for _ in range(10):
        box = middle(page)
        page.mouse.move(box["x"] + rng.uniform(2, box["width"] - 2), box["y"] + 20)
        page.wait_for_function("acro.graphs[0].plot.cursor.idx != null")
        q2, *values = shown(page, 0)
        assert values == [line[q2] for line in lines]


def test_arrows_do_not_run_together(site):
    """No tail or head lies nearer to another arrow's than a seventh of the distance of neighbours."""
    outcome = json.loads((site / "studies" / "figures-4-8.json").read_text())["outcome"]
    for figure in outcome["figures"]:
        path = figure["svg"].split('<path d="')[1].split('"')[0]
        arrows = np.array([[float(n) for n in arrow.replace("L", " ").split()[:4]] for arrow in path.split("M")[1:] if "L" in arrow])
        assert len(arrows) == 17 * 17
        tails, heads = arrows[:, :2], arrows[:, 2:]
        spacing = np.ptp(tails[:, 0]) / 16
        apart = np.linalg.norm(heads[:, None] - heads[None], axis=2) + 1e9 * np.eye(len(heads))
        between = np.linalg.norm(heads[:, None] - tails[None], axis=2) + 1e9 * np.eye(len(heads))
        assert min(apart.min(), between.min()) > spacing / 7, figure["caption"]
        assert np.linalg.norm(heads - tails, axis=1).max() == pytest.approx(0.85 * spacing, abs=0.02)  # two decimals of a pixel


def test_the_sliders_show_the_lens(site, look):
    page = look(site / "studies" / "figures-4-8.html")
    said = page.locator("#lens [role=status]")
    page.get_by_role("button", name="No distortion").click()
    assert said.inner_text() == "Largest displacement: 0.0000 image units, 0.0 pixels."
    page.get_by_role("slider", name="k1").fill("0.1")
    # (3), (4): k1 r^3 at the corner of the grid, r = 0.95 * sqrt(2).
    assert said.inner_text() == f"Largest displacement: {0.1 * (0.95 * 2**0.5) ** 3:.4f} image units, {25.6 * (0.95 * 2**0.5) ** 3:.1f} pixels."
    page.get_by_role("button", name="Figure 8").click()
    # (8): s2 r^2.
    assert said.inner_text().startswith(f"Largest displacement: {0.1 * 2 * 0.95**2:.4f} image units")
    assert page.locator("#lens output").all_inner_texts() == ["0.000", "0.000", "0.000", "0.000", "0.100"]


def test_no_name_is_broken(site, look):
    page = look(site / "index.html", 1400, 900)
    lines = page.locator(".filtered td:first-child a").evaluate_all("(links) => links.map((link) => [link.textContent, link.getClientRects().length])")
    assert lines and [name for name, count in lines if count > 1] == []
