"""Meshes by Bezier extraction: the only seam between the bases."""
