"""Traction laws of a bond that opens, or opens and slides."""
