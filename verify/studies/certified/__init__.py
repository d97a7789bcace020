"""`debond certify`: values of a scene that two codes agree on, each with its uncertainty and how that is made up.

The runs of both codes (`plan`), the budget of each code and the value of both (`budget`), `study`, `page`; what is kept
in the package and in the guide (`keeping`).
"""
