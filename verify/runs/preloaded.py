"""Imports all that runs import, in the process that forks them: most of a second, once. It is imported for that alone.

DOLFINx is left out: a process in which MPI runs must not be forked.
"""

import gc
from importlib import import_module

for _name in (
    "verify.cli",
    "verify.methods.solve",
    "verify.runs.run",
    "verify.checks.table",
    "iga.delamination",
    "iga.laws.laws",
    "verify.theory.arms.solve",
    "verify.theory.arms.brittle",
    "fem_reference.problem.delamination",
    "fem_reference.problem.mixed_laws",
):
    import_module(_name)

gc.freeze()  # the collections of the runs leave out what is here
