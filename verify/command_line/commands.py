"""The commands, in the order of `debond --help`; each module adds its options and runs."""

from __future__ import annotations

from verify.command_line.studies import (
    certify,
    compare,
    cost,
    effects,
    hard,
    law,
    reduce,
    solve,
    validate,
    vary,
    verify,
)
from verify.command_line.tools import completion, doctor, export, mesh, new, scenes, test

STUDIES = (verify, solve, cost, effects, vary, validate, certify, hard, law, reduce, compare)
TOOLS = (export, mesh, scenes, new, completion, doctor, test)
