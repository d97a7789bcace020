"""Bases: a file with a frozen `Basis` is one; `iga.bases.names` finds it. Every basis makes a `Mesh`."""
