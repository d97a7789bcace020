"""Bases, one file each; every basis makes a `Mesh`."""
