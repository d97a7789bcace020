"""Bezier extraction files (`.iga`)."""
