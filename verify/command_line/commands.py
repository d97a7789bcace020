"""The commands, in the order of `debond --help`."""

from __future__ import annotations

from verify.command_line.compare import compare
from verify.command_line.solving import solve
from verify.command_line.studies import certify, cost, effects, hard, law, reduce, validate, vary
from verify.command_line.tools import completion, doctor, export, mesh, new, peers, scenes, test
from verify.command_line.verification import verify

HELP_GROUPS = {
    "is a code right": (verify, peers, solve, certify, hard, law),
    "curves and tests": (compare, validate, reduce),
    "what it costs, what matters": (cost, effects, vary),
    "scenes and meshes": (scenes, new, export, mesh),
    "this program": (completion, doctor, test),
}
COMMANDS = tuple(one for group in HELP_GROUPS.values() for one in group)
