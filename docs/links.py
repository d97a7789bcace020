"""Links of a folder of pages: does each lead somewhere, and is everything that a page needs in the folder?

python links.py FOLDER     prints what is wrong; exit code 1 if anything is
"""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: Attributes by which a page loads what it needs; a link that is merely offered (`a href`) is another matter.
LOADS = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("use", "href")}
#: `link` elements that load nothing.
OFFERS = {"canonical", "prev", "next", "alternate", "edit"}
REMOTE = re.compile(r"(?:url\(|@import)\s*[\"']?\s*(?:https?:)?//", re.IGNORECASE)


class _Page(HTMLParser):
    """What a page loads, where its links lead, and which places in it have a name."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.linked: list[str] = []
        self.places: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attributes}
        self.places |= {given[name] for name in ("id", "name") if name in given}
        for name, value in given.items():
            if (tag, name) in LOADS and not (tag == "link" and set(given.get("rel", "").split()) & OFFERS):
                self.loaded.append(value)
            elif (tag, name) == ("a", "href"):
                self.linked.append(value)


def wrong(folder: Path) -> list[str]:
    """One sentence for every link that leads nowhere and for everything that is fetched from elsewhere."""
    pages = {path.resolve(): _Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    if not pages:
        return [f"{folder}: has no pages"]
    found = []
    for path, page in pages.items():
        name = path.relative_to(folder.resolve())
        for target in page.loaded:
            if urlsplit(target).netloc:
                found.append(f"{name}: fetches {target}")
        for target in page.loaded + page.linked:
            complaint = _leads_nowhere(path, target, pages, folder.resolve())
            if complaint:
                found.append(f"{name}: {complaint}")
    for path in sorted(folder.rglob("*.css")):
        if REMOTE.search(path.read_text(encoding="utf-8")):
            found.append(f"{path.relative_to(folder)}: fetches from elsewhere")
    return found


def _leads_nowhere(path: Path, target: str, pages: dict[Path, _Page], folder: Path) -> str:
    """What is wrong with a link, empty where nothing is."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return ""
    goal = path
    if parts.path:
        start = folder if parts.path.startswith("/") else path.parent
        goal = (start / unquote(parts.path).lstrip("/")).resolve()
    goal = goal / "index.html" if goal.is_dir() else goal
    if not goal.is_file():
        return f"{target} leads nowhere"
    place = unquote(parts.fragment)
    if place and not place.startswith("__") and goal in pages and place not in pages[goal].places:
        return f"{target} has no such place"
    return ""


if __name__ == "__main__":
    problems = wrong(Path(sys.argv[1]))
    print("\n".join(problems) or "every link leads somewhere, nothing is fetched from elsewhere")
    raise SystemExit(bool(problems))
