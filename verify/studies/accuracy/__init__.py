"""`debond solve --accuracy`: a curve as exact as asked for, at the least cost that is known.

Method and first mesh (`choice`), finer meshes until two agree (`verified`), distance and errors of two (`levels`).
"""
