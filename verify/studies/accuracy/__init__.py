"""`debond solve --accuracy`: a curve with the accuracy asked for, at the least known cost.

`choice` selects method and meshes, `verified` solves on finer meshes until two agree.
"""
