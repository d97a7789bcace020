"""Data reduction of a test or a run: where the rows come from, the table, the page, and a fit by a solver."""
