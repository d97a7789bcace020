"""Scenes in words: a new file, the list, the drawing in a terminal."""
