"""The figures of a scene."""
