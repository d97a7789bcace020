"""The study of effects: changes of the results and of the time by switching each of ``[effects]`` on and off.

Read in this order: `plan` (the runs), `row` (comparison of two runs), `study` (the whole study), `page`.
"""
