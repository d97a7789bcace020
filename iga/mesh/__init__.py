"""Meshes by Bezier extraction: the common form of all bases."""
