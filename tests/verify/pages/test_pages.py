"""Every page in a real browser, with and without scripts, light and dark, narrow and wide: what is drawn is read."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from browser import Browser, found  # noqa: E402
from made_up_pages import PAGES  # noqa: E402

pytestmark = pytest.mark.skipif(found() is None, reason="there is no Chromium")

FAULTS = Path(__file__).with_name("faults.js").read_text().rstrip()

#: CSS pixels: least size of the text of a page, of that of its figures, and the largest of both.
SIZES = "{ html: 11, figure: 6, largest: 48 }"

#: Ways to read a page, with scripts or none, each scheme and width; the others make every pair of them.
READERS = ((True, "light", 400), (False, "dark", 1300))
OTHER_READERS = ((True, "dark", 1300), (False, "light", 1300), (False, "dark", 400))

#: Width of a page of A4 within its margins of 11 mm, in CSS pixels.
PAPER = 710


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The pages by their names, each written once."""
    known: dict[str, Path] = {}

    def page(name: str) -> Path:
        if name not in known:
            known[name] = PAGES[name](tmp_path_factory.mktemp(name))
        return known[name]

    return page


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with Browser(found(), tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture(autouse=True)
def as_it_was(browser):
    browser.size(1300)
    browser.media()
    browser.scripts(True)


@pytest.fixture
def page(written, browser):
    """The report, opened."""
    browser.open(written("verify"))
    return written("verify")


def faults(browser: Browser, page: Path, scripts: bool, scheme: str, width: int) -> list[str]:
    """What is wrong with a page as one reader sees it."""
    browser.size(width)
    browser.media(scheme=scheme)
    browser.scripts(scripts)
    browser.open(page)
    asked = [address for address in browser.requests if not address.startswith(("file:", "data:"))]
    said = browser.ask(f"{FAULTS}({SIZES})")
    return [*(f"asks for {address}" for address in asked), *(f"console: {text}" for text in browser.complaints), *said]


@pytest.mark.parametrize("readers", [READERS, pytest.param(OTHER_READERS, marks=pytest.mark.slow)], ids=["some", "all"])
@pytest.mark.parametrize("name", PAGES)
def test_what_is_drawn_can_be_read(name, readers, written, browser):
    wrong = {
        (("with" if scripts else "without") + " scripts", scheme, width): said
        for scripts, scheme, width in readers
        if (said := faults(browser, written(name), scripts, scheme, width))
    }
    assert wrong == {}


STYLE = "svg { width: 300px; height: 100px } body { color: #222 } svg * { fill: #222; font-size: 12px }"
GOOD = """<p>A text.</p>
<svg viewBox="0 0 300 100"><text x="10" y="20">one</text><text x="10" y="40">two</text></svg>"""


@pytest.mark.parametrize(
    ("part", "fault"),
    [
        ("", ""),
        ('<svg viewBox="0 0 300 100"><path style="fill: black" d="M0 0H9V9z"/></svg>', "black: 1 times (path)"),
        (
            '<svg viewBox="0 0 300 100"><path style="fill: none; stroke: black" d="M0 0H9"/></svg>',
            "black: 1 times (path)",
        ),
        ('<p style="color: black">A text.</p>', 'black: "A text."'),
        ('<p style="color: #ccc">A text.</p>', 'contrast: "A text."'),
        ('<p style="font-size: 9px">A text.</p>', 'size: 9.0 px of "A text."'),
        ('<svg viewBox="0 0 900 300"><text x="10" y="40">small</text></svg>', 'size: 4.0 px of "small"'),
        ('<svg viewBox="0 0 300 100"><text x="280" y="20">outside</text></svg>', 'outside: "outside"'),
        ('<svg viewBox="0 0 300 100"><text x="9" y="20">one</text><text x="15" y="22">two</text></svg>', "overlap: "),
        ('<svg viewBox="0 0 300 100"><g></g></svg>', "empty: a figure"),
        ('<div style="width: 1500px">wide</div>', "page: "),
        ("<script>console.error('this is wrong')</script>", "console: "),
        ('<img src="http://127.0.0.1:9/x.png" alt="">', "asks for http://127.0.0.1:9/x.png"),
    ],
)
def test_every_fault_is_found(part, fault, browser, tmp_path):
    """A page without fault has none, and each that is planted is named."""
    (tmp_path / "page.html").write_text(f"<!DOCTYPE html><style>{STYLE}</style><body>{GOOD}{part}</body>")
    said = faults(browser, tmp_path / "page.html", True, "light", 1300)
    assert any(fault in one for one in said) if fault else said == []


def test_a_page_that_says_nothing_is_a_fault(browser, tmp_path):
    (tmp_path / "page.html").write_text(f"<!DOCTYPE html><style>{STYLE}</style><body></body>")
    assert faults(browser, tmp_path / "page.html", True, "light", 1300) == ["empty: no text is seen"]


def test_styles_of_figures_are_read_where_scripts_run(written, browser):
    """The bars of what effects cost have their colours, and not the black of no style."""
    browser.open(written("effects"))
    colours = "new Set([...document.querySelectorAll('svg.plot path')].map((one) => getComputedStyle(one).fill)).size"
    assert browser.ask(colours) > 5


def test_letters_of_a_chart_keep_their_size_where_the_window_becomes_narrow(written, browser):
    """The chart is drawn anew, in the width that there is."""
    browser.open(written("cost"))
    widths = []
    for width in (1300, 400, 1300):
        browser.size(width)
        drawn = "requestAnimationFrame(() => requestAnimationFrame(() => done(document.querySelector('.chart'))))"
        found = f"new Promise((done) => {drawn}).then((one) => [one.getScreenCTM().a, one.clientWidth])"
        scale, across = browser.ask(found)
        assert scale > 0.95
        widths.append(across)
    assert widths[1] < 400 < widths[0] == widths[2]


# --- the report: by keyboard, by its landmarks, in print


def test_has_landmarks_headings_in_order_and_names(browser, page):
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


def test_tables_have_captions_and_heads_have_scopes(browser, page):
    bare = (
        "[...document.querySelectorAll('table')].filter((t) => !t.caption?.textContent.trim()).map((t) => t.className)"
    )
    assert browser.ask("document.querySelectorAll('table').length") > 8
    assert browser.ask(bare) == []
    assert browser.ask("[...document.querySelectorAll('th:not([scope])')].map((h) => h.textContent)") == []


def test_links_and_runs_are_reached_by_tab_with_a_visible_focus(browser, page):
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


def test_a_link_opens_what_it_leads_to_and_print_opens_all(browser, page):
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


def test_what_does_not_hold_is_not_folded(browser, page):
    """At the top and in its section; what holds is, beside it too."""
    seen = "[...document.querySelectorAll('.{kind} .mark.{tone}')].map((one) => one.checkVisibility())"
    for kind in ("lost", "checks"):
        assert browser.ask(seen.format(kind=kind, tone="bad")) == [True]
    held = browser.ask(seen.format(kind="checks", tone="good"))
    assert held and not any(held)


def test_nothing_is_cut_in_print(browser, page):
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


def test_is_small(page):
    assert page.stat().st_size < 8e6 / 8  # of the eight scenes of a full verification
