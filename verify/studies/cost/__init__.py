"""What accuracy costs in time: every method on ever finer meshes, each held against one converged reference.

Read in this order: `ladder` (which runs), `reference` (what they are held against), `row` (one run, measured),
`study` (the sweep), `findings` (what the rows say), `page`.
"""
