"""The price of viscosity: what regularising a bond that slides does to its curve, and what time it saves.

Read in this order: `plan` (the runs), `row` (one of them against that without viscosity), `study`, `page`.
"""
