"""Tractions on the paths: of functions, of the solvers, of files."""
