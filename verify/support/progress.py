"""Progress on stderr: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import monotonic
from typing import Any, Self

LINES_EVERY_SECONDS = 10.0


class Progress:
    """Progress of work up to ``total``, set by ``advance``.

    A bar on a terminal with tqdm, otherwise a line at most every ten seconds; both with the remaining time.

    Parameters
    ----------
    pace : expected progress per second; 0 if unknown
    """

    def __init__(self, title: str, total: float, quiet: bool = False, pace: float = 0.0) -> None:
        self._title, self._total, self._done, self._pace = title, total, 0.0, pace
        self._quiet = quiet
        self._start = self._said = self._reached = monotonic()
        self._bar = None if quiet else _bar(title, total)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def advance(self, done: float, news: str = "") -> None:
        """Set the progress to ``done``; ``news`` is shown beside the bar."""
        done = min(done, self._total)
        step, self._done, self._reached = done - self._done, done, monotonic()
        if self._bar is not None:
            self._bar.set_postfix_str(news, refresh=False)
            self._bar.update(step)
        elif not self._quiet and monotonic() - self._said > LINES_EVERY_SECONDS:
            self.line(f"{self._title}: {done / self._total:4.0%}{self.left} {news}")

    def alive(self, news: str) -> None:
        """Show that the work goes on without progress."""
        if self._bar is not None:
            self._bar.set_postfix_str(f"{news}{self.left}")
        elif not self._quiet and monotonic() - self._said > LINES_EVERY_SECONDS:
            self.line(f"{self._title}: {news}{self.left}")

    def line(self, text: str) -> None:
        """Print a line, above the bar if there is one."""
        self._said = monotonic()
        if self._bar is not None:
            self._bar.write(text, file=sys.stderr)
        elif not self._quiet:
            print(text, file=sys.stderr, flush=True)

    @property
    def left(self) -> str:
        """Remaining time at the mean rate so far, as ", 3 min 20 s left"; empty if unknown.

        The rate is that up to the last call of `advance`; the time since then is subtracted.
        """
        since, spent = monotonic() - self._reached, self._reached - self._start
        if 0.0 < self._done < self._total * (1.0 - 1e-9):  # up to rounding of added times
            about, left = "", spent * (self._total / self._done - 1.0) - since
        else:
            about, left = "about ", self._total / self._pace - since if self._pace and not self._done else 0.0
        return f", {about}{duration(left)} left" if left > 0.0 else ""


@contextmanager
def telling(title: str, seconds: float) -> Iterator[None]:
    """Progress of work without intermediate results that takes about ``seconds``."""
    over = Event()

    def tick(progress: Progress) -> None:
        while not over.wait(1.0):
            progress.alive("at work")

    with Progress(title, seconds, pace=1.0) as progress:
        clock = Thread(target=tick, args=(progress,), daemon=True)
        clock.start()
        try:
            yield
        finally:
            over.set()
            clock.join()


def duration(seconds: float) -> str:
    """A time in at most two units: 8.2 s, 3 min 20 s, 2 h 5 min."""
    if seconds < 99.5:
        return f"{seconds:.2g} s" if seconds < 9.95 else f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes < 99 else f"{minutes // 60} h {minutes % 60} min"


def _bar(title: str, total: float) -> Any:
    """A bar, or None: tqdm is optional."""
    if not sys.stderr.isatty():
        return None
    try:
        from tqdm import tqdm
    except ImportError:
        return None
    form = "{l_bar}{bar}| {elapsed}<{remaining} {postfix}"
    return tqdm(total=total, desc=title, bar_format=form, file=sys.stderr, leave=False, smoothing=0)
