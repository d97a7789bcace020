"""Mesh, forms and matrices in DOLFINx."""
