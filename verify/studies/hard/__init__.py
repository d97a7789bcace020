"""The hard cases: scenes on which cohesive codes stop or go wrong, each with its criterion as code.

``case`` says what a case is, ``cases`` names them all, ``criteria`` holds what every run of every case must show,
``one`` runs a case on a basis, ``suite`` runs them all and prints the matrix, ``page`` draws it.
"""
