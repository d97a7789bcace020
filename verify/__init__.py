"""Scenes, methods, checks and reports: one problem solved by independent codes and compared."""

__version__ = "0.1.0"
