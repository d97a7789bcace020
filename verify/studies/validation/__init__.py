"""`debond validate`: a statement of ASME V&V 20 on the error of the model against a measured curve.

The scene as it is, on coarser meshes, and with each uncertain number a little smaller and larger (`plan`); what is held
against the data (`quantities`); the budget of uncertainties (`budget`) and the statement (`statement`).
"""
