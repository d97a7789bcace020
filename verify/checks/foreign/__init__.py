"""Curves of other codes: what they go through of a programme, and their checks."""
