"""T-meshes and their spline functions."""
