"""`debond validate`: a statement of ASME V&V 20 on the error of the model against a measured curve.

`quantities` are the numbers that are compared with the data, `statement` is made of their budgets; `study` has the
runs: the scene as it is, on coarser meshes, and with each uncertain number a little smaller and larger.
"""
