"""Which single cause explains best that a load-opening curve is not that of a scene, and what a pass cannot see.

Causes in the scene (`causes`) are solved by NURBS on few unknowns (`solutions`), causes in the curve are undone on it
(`on_curve`); `classify` fits and ranks them, and says it in a sentence; `blind` says which would go unseen.
"""
