"""Closed forms; imports no solver."""
