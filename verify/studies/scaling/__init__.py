"""The study of scaling: growth of time and memory with the unknowns, and the speed-up by more MPI ranks.

Read in this order: `plan` (the runs), `ranks` (a run under mpirun), `row` (measurements of a run), `growth` (exponents,
speed-ups), `study` (the whole study), `page`.
"""
