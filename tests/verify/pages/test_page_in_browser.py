"""The report in a real browser, beside what holds of every page: by keyboard, by its landmarks, in print."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from browser import Browser, found  # noqa: E402
from made_up_pages import verification  # noqa: E402

pytestmark = pytest.mark.skipif(found() is None, reason="there is no Chromium")

#: Width of a page of A4 within its margins of 11 mm, in CSS pixels.
PAPER = 710


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return verification(tmp_path_factory.mktemp("page"))


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


def test_links_and_runs_are_reached_by_tab_with_a_visible_focus(browser: Browser) -> None:
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
    links = browser.ask("[...document.querySelectorAll('a')].filter((a) => a.checkVisibility()).length")
    assert tags.count("A") == links and tags.count("INPUT") > 0 and "SELECT" in tags
    assert "path point" in seen  # the runs of the chart


def test_a_link_opens_what_it_leads_to_and_print_opens_all(browser: Browser, page: Path) -> None:
    browser.open(page)
    open_ones = "[...document.querySelectorAll('details')].filter((d) => d.open).length"
    row = "document.getElementById('scene-1-run-nurbs')"
    assert not browser.ask(f"{row}.checkVisibility()")
    browser.ask("location.hash = '#scene-1-run-nurbs'")
    assert browser.ask(f"new Promise((done) => setTimeout(() => done({row}.checkVisibility()), 200))")
    before = browser.ask(open_ones)
    browser.ask("dispatchEvent(new Event('beforeprint'))")
    assert browser.ask(open_ones) == browser.ask("document.querySelectorAll('details').length") > before
    browser.ask("dispatchEvent(new Event('afterprint'))")
    assert browser.ask(open_ones) == before


def test_what_does_not_hold_is_not_folded(browser: Browser, page: Path) -> None:
    """At the top and in its section; what holds is, beside it too."""
    browser.open(page)
    seen = "[...document.querySelectorAll('.{kind} .mark.{tone}')].map((one) => one.checkVisibility())"
    for kind in ("lost", "checks"):
        assert browser.ask(seen.format(kind=kind, tone="bad")) == [True]
    held = browser.ask(seen.format(kind="checks", tone="good"))
    assert held and not any(held)


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
