"""Convergence of plane elasticity on one patch."""
