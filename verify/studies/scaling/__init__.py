"""How time and memory grow with the unknowns, what more ranks gain here, and what that lets expect of many.

Read in this order: `plan` (which runs), `ranks` (a run under mpirun), `row` (one run, measured), `growth` (exponents),
`expect` (many ranks), `study` (the sweep), `page`.
"""
