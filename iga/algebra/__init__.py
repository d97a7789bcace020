"""Banded and dense matrices and their factors."""
