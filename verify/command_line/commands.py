"""The commands, in the order of `debond --help`."""

from __future__ import annotations

from verify.command_line.compare import compare
from verify.command_line.peers import peers
from verify.command_line.solving import solve
from verify.command_line.studies import certify, cost, effects, hard, law, reduce, validate, vary
from verify.command_line.tools import completion, doctor, export, mesh, new, scenes, test
from verify.command_line.verification import verify

COMMANDS = (
    *(verify, solve, cost, effects, vary, validate, certify, hard, law, reduce, compare),
    *(export, peers, mesh, scenes, new, completion, doctor, test),
)
