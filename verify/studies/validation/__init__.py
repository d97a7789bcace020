"""`debond validate`: a statement of ASME V&V 20 on the error of the model against a measured curve.

`plan` has the runs: the scene as it is, on coarser meshes, and with each uncertain number a little smaller and larger;
`quantities` the numbers that are compared with the data; `budget` the uncertainties; `statement` the statement.
"""
