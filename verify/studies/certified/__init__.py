"""`debond certify`: values of a scene on which two codes agree, each with its uncertainty and the budget of it.

`study` has the runs of both codes, `values` the uncertainty of each code and the common value. `keeping` writes the
values to the package and the guide.
"""
