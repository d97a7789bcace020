"""Surfaces, closest points, gaps, slips and tractions."""
