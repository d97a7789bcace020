"""The double cantilever beam."""

from iga.dcb.dcb import build, solve
from iga.dcb.problem import Problem

__all__ = ["Problem", "build", "solve"]
