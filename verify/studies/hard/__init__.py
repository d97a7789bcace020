"""The hard cases: scenes on which cohesive codes stop or give wrong results, each with criteria as code.

``case`` defines a case, ``cases`` lists them all, ``criteria`` has the criteria of every run, ``one`` runs a case with
one basis, ``suite`` runs all cases and prints the matrix, ``page`` draws it.
"""
