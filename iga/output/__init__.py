"""Rows, snapshots and frames of a run."""
