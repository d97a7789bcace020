"""Snapshots and frames of a run."""
