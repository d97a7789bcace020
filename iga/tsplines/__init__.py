"""T-meshes and their spline functions, and splines on unstructured quadrilateral meshes."""
