"""How time and memory grow with the unknowns, and what more ranks gain on this machine.

Read in this order: `plan` (which runs), `ranks` (a run under mpirun), `row` (one run, measured), `growth` (exponents,
speed-ups), `study` (the sweep), `page`.
"""
