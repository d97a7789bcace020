"""What every effect changes and what it costs: each of ``[effects]`` on and off, everything else as the scene says.

Read in this order: `plan` (which runs), `row` (two runs held against each other), `study` (the sweep), `page`.
"""
