"""Ctrl-C: one sentence and exit code 130, wherever in the program it comes.

Python raises an interrupt as an exception between any two instructions. Where that is a finalizer it is printed and
lost, and where a compiled module is just being imported it becomes an `ImportError`: hence the time is kept as well.
"""

from __future__ import annotations

import _thread
import gc
import math
import os
import signal
import sys
from collections.abc import Callable
from time import monotonic, sleep
from types import FrameType
from typing import Any, NoReturn

INTERRUPTED = 130

#: Seconds within which a second signal is the same interrupt: a terminal and a launcher may both send one.
ONE_INTERRUPT_SECONDS = 1.0

#: Seconds after which a finalizer is over.
LEFT_SECONDS = 0.01

_came: list[float] = []  # when


def came() -> bool:
    """Whether the program was interrupted, whatever became of the exception."""
    return bool(_came)


def is_one(error: BaseException) -> bool:
    """Whether an exception is an interrupt, or what a library has made of one."""
    return isinstance(error, KeyboardInterrupt) or (came() and isinstance(error, Exception))


def end_at_once() -> None:
    """From here on an interrupt ends the process: nothing has been done. A signal that the launcher held is let in."""
    signal.signal(signal.SIGINT, _end)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def running(main: Callable[[], int]) -> NoReturn:
    """Call ``main`` with interrupts as exceptions, and end the process with its exit code.

    After an interrupt the process ends without the clean-up of the interpreter, which waits for threads.
    """
    sys.unraisablehook = _not_lost
    signal.signal(signal.SIGINT, _raise)
    code = main()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done
    if came():
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        os._exit(code)
    gc.freeze()  # the last collections would look at all objects, a tenth of a second, which end with the process
    sys.exit(code)


def ignore_more() -> None:
    """The program is about to end: a further interrupt changes nothing."""
    if came():
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _end(*_: object) -> NoReturn:
    os.write(2, b"debond: interrupted; the same command again starts over\n")
    os._exit(INTERRUPTED)


def _raise(number: int, frame: FrameType | None) -> None:
    first = not _came
    if first or monotonic() - _came[-1] > ONE_INTERRUPT_SECONDS:
        _came.append(monotonic())
        raise KeyboardInterrupt


def _again() -> None:
    """Interrupt the main thread when it has left the finalizer, and the hook with it."""
    sleep(LEFT_SECONDS)
    _thread.interrupt_main()


def _not_lost(what: Any) -> None:
    """Raise an interrupt again that came in a finalizer, where no exception gets out."""
    if issubclass(what.exc_type, KeyboardInterrupt):
        _came[:] = [-math.inf]
        _thread.start_new_thread(_again, ())
    elif not came():
        sys.__unraisablehook__(what)
