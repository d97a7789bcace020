"""The report in a real browser: it asks for nothing, says nothing on the console, and can be read by everybody."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

import made_up_studies  # noqa: E402
from browser import Browser, found  # noqa: E402
from made_up_runs import ENVIRONMENT, made_up, scene_report  # noqa: E402

from verify import report  # noqa: E402
from verify.included import found_in  # noqa: E402
from verify.verdict import SceneReport  # noqa: E402

pytestmark = pytest.mark.skipif(found() is None, reason="there is no Chromium")

#: Width of a page of A4 within its margins of 11 mm, in CSS pixels.
PAPER = 710

#: Contrast of the text of every element that has any with what is painted behind it (WCAG 2.1, 1.4.3).
CONTRASTS = """
(() => {
  const canvas = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  const over = (colour, ground) => {
    canvas.fillStyle = `rgb(${ground})`; canvas.fillRect(0, 0, 1, 1);
    canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1);
    return [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3);
  };
  const light = (rgb) => {
    const [r, g, b] = rgb.map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (node) => {
    const behind = node.parentElement ? ground(node.parentElement) : [255, 255, 255];
    return over(getComputedStyle(node).backgroundColor, behind);
  };
  const low = [];
  for (const node of document.querySelectorAll("body *")) {
    const own = [...node.childNodes].some((part) => part.nodeType === 3 && part.textContent.trim());
    if (!own || !node.getClientRects().length || node.closest("script, style, option, title")) continue;
    const inside = node.closest("svg"), style = getComputedStyle(node), behind = ground(inside || node);
    const text = over(inside ? style.fill : style.color, behind);
    const [a, b] = [light(text), light(behind)].sort((x, y) => y - x);
    if ((a + 0.05) / (b + 0.05) < 4.5) low.push(`${node.tagName} ${node.textContent.trim()} ${text} on ${behind}`);
  }
  return low;
})()
"""


def meshes(given: SceneReport) -> SceneReport:
    """The scene with two coarser NURBS meshes, and with fields of two runs alone, as they take long to draw."""
    fine = given.runs[0]
    coarse = (
        replace(fine, label=f"NURBS {n}", folder=f"{fine.folder}-{n}", result=made_up("nurbs", wobble, 1.0, n, n // 18))
        for n, wobble in ((978, 1.6e-3), (489, 3.2e-3))
    )
    bare = [replace(run, result=replace(run.result, snapshots=())) for run in (given.runs[1], *given.runs[3:], *coarse)]
    return replace(given, runs=(fine, given.runs[2], *bare))


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One scene with everything, and the studies of all other commands."""
    out = tmp_path_factory.mktemp("page")
    made_up_studies.cost(out / "cost")
    made_up_studies.effects(out / "effects")
    made_up_studies.hard(out / "hard")
    report.write((meshes(scene_report()),), out / "report.html", ENVIRONMENT, included=found_in(out))
    return out / "report.html"


@pytest.fixture(scope="module")
def browser(page: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(found(), tmp_path_factory.mktemp("profile")) as opened:
        opened.size(1280)
        opened.open(page)
        yield opened


@pytest.fixture(autouse=True)
def as_it_was(browser: Browser) -> None:
    browser.size(1280)
    browser.media()


def test_asks_for_nothing_and_complains_of_nothing(browser: Browser) -> None:
    assert {address.partition(":")[0] for address in browser.requests} == {"file", "data"}
    assert sum(address.startswith("file:") for address in browser.requests) == 1
    assert browser.complaints == []


def test_has_landmarks_headings_in_order_and_names(browser: Browser) -> None:
    for tag in ("header", "main", "footer", "h1"):
        assert browser.ask(f"document.querySelectorAll('{tag}').length") == 1, tag
    assert browser.ask("document.querySelector('nav').getAttribute('aria-label')") == "Contents"
    levels = browser.ask("[...document.querySelectorAll('h1,h2,h3,h4')].map((h) => Number(h.tagName[1]))")
    assert levels[0] == 1 and all(b <= a + 1 for a, b in zip(levels, levels[1:], strict=False))
    nameless = """[...document.querySelectorAll('svg, img')].filter((one) => one.ariaHidden !== 'true' &&
        !one.getAttribute('aria-label') &&
        !document.getElementById(one.getAttribute('aria-labelledby'))?.textContent
    ).map((one) => one.outerHTML.slice(0, 80))"""
    assert browser.ask(nameless) == []


def test_tables_have_captions_and_heads_have_scopes(browser: Browser) -> None:
    bare = (
        "[...document.querySelectorAll('table')].filter((t) => !t.caption?.textContent.trim()).map((t) => t.className)"
    )
    assert browser.ask("document.querySelectorAll('table').length") > 8
    assert browser.ask(bare) == []
    assert browser.ask("[...document.querySelectorAll('th:not([scope])')].map((h) => h.textContent)") == []


def test_no_word_of_a_figure_sticks_out_of_it(browser: Browser) -> None:
    """In the font that the browser has found; the frames that the slider hides are shown for it."""
    browser.ask("document.querySelectorAll('.frame, details').forEach((f) => { f.hidden = false; f.open = true; })")
    cut = """[...document.querySelectorAll('svg.plot text')].filter((text) => {
        const a = text.getBoundingClientRect(), b = text.closest('svg').getBoundingClientRect();
        const out = [b.left - a.left, a.right - b.right, b.top - a.top, a.bottom - b.bottom];
        return a.width && Math.max(...out) > 1;
    }).map((text) => text.textContent)"""
    found = browser.ask("document.querySelectorAll('svg.plot text').length"), browser.ask(cut)
    browser.ask("location.reload()")
    assert found[0] > 300 and found[1] == []


def test_slider_shows_one_opening_at_a_time_by_keyboard(browser: Browser) -> None:
    shown = "[...document.querySelectorAll('.frame')].map((f) => f.getClientRects().length > 0)"
    assert browser.ask(shown) == [False, False, True]
    browser.ask("document.querySelector('.stepper input').focus()")
    browser.press("ArrowLeft", 37)
    assert browser.ask(shown) == [False, True, False]
    assert browser.ask("document.querySelector('.stepper output').textContent") == "1\u00a0mm"
    assert "load" in browser.ask("document.querySelector('.stepper input').getAttribute('aria-valuetext')")


def test_links_slider_and_runs_are_reached_by_tab_with_a_visible_focus(browser: Browser) -> None:
    browser.ask("document.activeElement.blur(), getSelection().removeAllRanges(), scrollTo(0, 0)")
    browser.open(Path(browser.ask("decodeURI(location.pathname)")))
    seen = []
    for _ in range(400):
        browser.press("Tab", 9)
        what, outline = browser.ask(
            "[document.activeElement.tagName + ' ' + document.activeElement.getAttribute('class'), "
            "getComputedStyle(document.activeElement).outlineStyle]"
        )
        if what.startswith("BODY"):
            break
        seen.append(what)
        assert outline not in ("none", ""), what
    tags = [what.split()[0] for what in seen]
    links = browser.ask("[...document.querySelectorAll('a')].filter((a) => a.getClientRects().length).length")
    assert tags.count("A") == links and tags.count("INPUT") > 1 and "SELECT" in tags
    assert "path point" in seen  # the runs of the chart


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_its_ground(browser: Browser, scheme: str) -> None:
    browser.media(scheme=scheme)
    ground = browser.ask("getComputedStyle(document.body).backgroundColor")
    assert ground == {"light": "rgb(255, 255, 255)", "dark": "rgb(18, 22, 28)"}[scheme]
    assert browser.ask(CONTRASTS) == []


def test_is_readable_on_a_phone(browser: Browser) -> None:
    browser.size(400)
    assert browser.ask("document.scrollingElement.scrollWidth") <= 400
    small = """[...document.querySelectorAll('p, li, td, th, figcaption, dd')].filter(
        (one) => one.getClientRects().length && parseFloat(getComputedStyle(one).fontSize) < 12).length"""
    assert browser.ask(small) == 0


def test_nothing_is_cut_in_print(browser: Browser) -> None:
    browser.size(PAPER)
    browser.media("print")
    cut = f"""[...document.querySelectorAll('main *')].filter((one) => {{
        const box = one.getBoundingClientRect();
        return box.width > 1 && (box.right > {PAPER} + 1 || box.left < -1) && !one.closest('svg *, .unseen');
    }}).map((one) => one.tagName + ' ' + one.getAttribute('class') + ' ' + one.getBoundingClientRect().right)"""
    assert browser.ask(cut) == []
    clipped = """[...document.querySelectorAll('main *')].filter((one) => !one.closest('svg, .unseen') &&
        getComputedStyle(one).overflowX !== 'visible' && one.scrollWidth > one.clientWidth + 1).length"""
    assert browser.ask(clipped) == 0
    assert browser.ask("getComputedStyle(document.querySelector('.controls')).display") == "none"
    assert browser.printed().startswith(b"%PDF")


def test_is_small(page: Path) -> None:
    assert page.stat().st_size < 8e6 / 8  # of the eight scenes of a full verification
