"""Scenes written down for other codes: mesh, node sets, interface pairs, materials, law and steps."""
