"""`debond solve --accuracy`: a curve with the accuracy asked for, at the least known cost.

`choice` selects method and first mesh, `verified` solves on finer meshes until two agree, `levels` has the distance of
two meshes and the bound of the error.
"""
