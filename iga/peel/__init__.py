"""The peel test."""

from iga.peel.peel import build, solve
from iga.peel.problem import Moduli, Problem

__all__ = ["Moduli", "Problem", "build", "solve"]
