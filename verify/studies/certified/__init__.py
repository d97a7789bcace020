"""`debond certify`: values of a scene on which two codes agree, each with its uncertainty and the budget of it.

`plan` has the runs of both codes, `budget` the uncertainty of each code and the common value; then `study` and `page`.
`keeping` writes the values to the package and the guide.
"""
