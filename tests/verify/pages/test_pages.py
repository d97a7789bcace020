"""Every page in a real browser, with and without scripts, light and dark, narrow and wide: what is drawn is read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
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
WIDTHS = (400, 1300)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The pages by their names, each written once."""
    known: dict[str, Path] = {}

    def page(name: str) -> Path:
        if name not in known:
            known[name] = PAGES[name](tmp_path_factory.mktemp(name))
        return known[name]

    return page


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(found(), tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def faults(browser: Browser, page: Path, scripts: bool, scheme: str, width: int) -> list[str]:
    """What is wrong with a page as one reader sees it."""
    browser.size(width)
    browser.media(scheme=scheme)
    browser.scripts(scripts)
    browser.open(page)
    asked = [address for address in browser.requests if not address.startswith(("file:", "data:"))]
    said = browser.ask(f"{FAULTS}({SIZES})")
    return [*(f"asks for {address}" for address in asked), *(f"console: {text}" for text in browser.complaints), *said]


@pytest.mark.parametrize("name", PAGES)
def test_what_is_drawn_can_be_read(name: str, written: Callable[[str], Path], browser: Browser) -> None:
    wrong = {
        (("with" if scripts else "without") + " scripts", scheme, width): said
        for scripts, scheme, width in product((True, False), ("light", "dark"), WIDTHS)
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
def test_every_fault_is_found(part: str, fault: str, browser: Browser, tmp_path: Path) -> None:
    """A page without fault has none, and each that is planted is named."""
    (tmp_path / "page.html").write_text(f"<!DOCTYPE html><style>{STYLE}</style><body>{GOOD}{part}</body>")
    said = faults(browser, tmp_path / "page.html", True, "light", 1300)
    assert any(fault in one for one in said) if fault else said == []


def test_a_page_that_says_nothing_is_a_fault(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text(f"<!DOCTYPE html><style>{STYLE}</style><body></body>")
    assert faults(browser, tmp_path / "page.html", True, "light", 1300) == ["empty: no text is seen"]


def test_styles_of_figures_are_read_where_scripts_run(written: Callable[[str], Path], browser: Browser) -> None:
    """The bars of what accuracy costs have the colours of their phases, and not the black of no style."""
    browser.size(1300)
    browser.media()
    browser.scripts(True)
    browser.open(written("cost"))
    colours = "new Set([...document.querySelectorAll('svg.plot path')].map((one) => getComputedStyle(one).fill)).size"
    assert browser.ask(colours) > 5


def test_letters_of_a_chart_keep_their_size_where_the_window_becomes_narrow(
    written: Callable[[str], Path], browser: Browser
) -> None:
    """The chart is drawn anew, in the width that there is."""
    browser.size(1300)
    browser.media()
    browser.scripts(True)
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
