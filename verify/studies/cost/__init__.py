"""What accuracy costs in time: every method on ever finer meshes, each compared with one converged reference.

Read in this order: `ladder` (which runs), `reference` (the curve they are compared with), `row` (measurements of one
run), `study` (the sweep), `findings` (evaluation of the rows), `page`.
"""
