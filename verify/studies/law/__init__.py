"""Anybody's traction law held against the definition, at one point: paths, tractions, checks, defects."""
