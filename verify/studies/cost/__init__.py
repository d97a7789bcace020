"""What accuracy costs in time: every method on ever finer meshes, each compared with one converged reference.

Read in this order: `grid` (meshes and steps), `plan` (what is searched), `search` (which runs come next), `reference`
(the curve they are compared with), `row` (measurements of one run), `study` (the runs), `findings` (evaluation of the
rows), `page`.
"""
