"""Progress on stderr: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
from time import monotonic
from types import TracebackType
from typing import Any, Self

LINES_EVERY_SECONDS = 10.0


class Progress:
    """Counts up to ``total``; ``advance`` to where the work is now.

    On a terminal with tqdm a bar, otherwise a line when there is news after ten seconds.
    """

    def __init__(self, title: str, total: float, quiet: bool = False) -> None:
        self._title, self._total, self._done = title, total, 0.0
        self._quiet = quiet
        self._said = monotonic()
        self._bar = None if quiet else _bar(title, total)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()

    def advance(self, done: float, news: str = "") -> None:
        """``done`` of ``total``; ``news`` is shown beside the bar."""
        step, self._done = done - self._done, done
        if self._bar is not None:
            self._bar.set_postfix_str(news, refresh=False)
            self._bar.update(min(step, self._total - self._bar.n))
        elif not self._quiet and monotonic() - self._said > LINES_EVERY_SECONDS:
            self.line(f"{self._title}: {done / self._total:4.0%} {news}")

    def line(self, text: str) -> None:
        """A whole line, above the bar where there is one."""
        self._said = monotonic()
        if self._bar is not None:
            self._bar.write(text, file=sys.stderr)
        elif not self._quiet:
            print(text, file=sys.stderr, flush=True)


def _bar(title: str, total: float) -> Any:
    """A bar, or None: tqdm is optional."""
    if not sys.stderr.isatty():
        return None
    try:
        from tqdm import tqdm
    except ImportError:
        return None
    form = "{l_bar}{bar}| {elapsed}<{remaining} {postfix}"
    return tqdm(total=total, desc=title, bar_format=form, file=sys.stderr, leave=False)
