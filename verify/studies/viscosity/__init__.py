"""The price of viscosity: the change of the curve by regularising a bond that slides, and the time it saves.

Read in this order: `plan` (the runs), `row` (one of them against that without viscosity), `study`, `page`.
"""
