"""Traction laws, surfaces, closest points, gaps and tractions."""
