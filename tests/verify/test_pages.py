"""Every page in a real browser, with and without scripts, light and dark, narrow and wide: what is drawn is read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from browser import Browser, found  # noqa: E402
from pages import PAGES  # noqa: E402

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
