"""Any delamination specimen: its problem, the meshes of its bodies, its supports, and its solution."""

from iga.delamination.problem import Problem
from iga.delamination.solution import build, solve

__all__ = ["Problem", "build", "solve"]
