"""Checks of one run, and of runs against each other."""
