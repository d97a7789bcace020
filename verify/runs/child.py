"""The processes of runs. They end with their parent: else they would slow down the next runs.

``python -m verify.runs.child MODULE ARGUMENT ...`` runs a module. Without arguments it has imported the package and
forks a process a run, so that the imports, most of a second, are done once; `verify.runs.server` is its other end.
"""

from __future__ import annotations

import ctypes
import gc
import importlib
import json
import os
import runpy
import select
import signal
import sys
from typing import NoReturn

#: prctl(2): sends a signal when the parent dies. Only on Linux; on other systems the run continues to its end.
PR_SET_PDEATHSIG = 1

#: mallopt(3) parameters of glibc and their values: keep up to 256 MB, and serve blocks up to 32 MB from the heap.
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = (-1, 256 << 20), (-3, 32 << 20)

#: What imports all that runs import; DOLFINx must not be copied, since MPI is then running.
IMPORTED = (
    "verify.cli",
    "verify.methods.solve",
    "verify.runs.run",
    "verify.checks.table",
    "iga.delamination",
    "iga.laws.mixed_laws",
    "verify.theory.arms.solve",
    "verify.theory.arms.brittle",
    "fem_reference.problem.delamination",
    "fem_reference.problem.mixed_laws",
)


def die_with_parent() -> None:
    """Ask the system to end this process when its parent ends, in whatever way."""
    try:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    except (OSError, AttributeError, TypeError):
        return


def keep_freed_memory() -> None:
    """Let the allocator reuse freed blocks instead of returning them to the system.

    By default glibc returns every large array when it is freed, and the next Newton iteration fetches and clears the
    same pages again, which was measured to cost five times the assembly. Without glibc this does nothing.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return
    for parameter, value in (M_TRIM_THRESHOLD, M_MMAP_THRESHOLD):
        mallopt(parameter, value)


def run(words: list[str]) -> None:
    """Run a module with arguments as the main program."""
    die_with_parent()
    module, sys.argv[:] = words[0], words
    runpy.run_module(module, run_name="__main__", alter_sys=True)


def serve() -> None:
    """Do one run after the other until standard input ends.

    A line of JSON has ``words``, the path of the ``log``, and the folder ``cwd``; answered by the process id and, when
    the run has ended, by its exit code, or -n after signal n.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt is for the runs, and for who asks for them
    reader, writer = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(writer)
    asking = select.poll()
    asking.register(0, select.POLLIN)
    for name in IMPORTED:
        if any(event & select.POLLHUP for _, event in asking.poll(0)):
            return
        importlib.import_module(name)
    gc.freeze()  # the collections of the runs leave out what is here
    while asked := os.read(0, 1 << 20):
        pid = os.fork()
        if pid == 0:
            signal.set_wakeup_fd(-1)
            for number in (signal.SIGCHLD, signal.SIGINT):
                signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
            _child(**json.loads(asked))
        _say(pid)
        ended, status = os.waitpid(pid, os.WNOHANG)
        while not ended:
            ready, _, _ = select.select([0, reader], [], [])
            if 0 in ready:  # nothing is sent meanwhile: this is its end
                os.kill(pid, signal.SIGTERM)
                return
            os.read(reader, 1 << 10)
            ended, status = os.waitpid(pid, os.WNOHANG)
        _say(os.waitstatus_to_exitcode(status))


def _say(number: int) -> None:
    os.write(1, b"%d\n" % number)


def _child(words: list[str], log: str, cwd: str) -> NoReturn:
    """Run with standard output and error in the log, and end as the interpreter would."""
    for target, name, how in ((0, os.devnull, os.O_RDONLY), (1, log, os.O_WRONLY | os.O_APPEND | os.O_CREAT)):
        opened = os.open(name, how)
        os.dup2(opened, target)
        os.close(opened)
    os.dup2(1, 2)
    os.chdir(cwd)
    run(words)
    sys.exit(0)


if __name__ == "__main__":
    if sys.argv[1:]:
        run(sys.argv[1:])
    else:
        serve()
