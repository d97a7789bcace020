"""Scenes, methods, checks and reports: one problem solved by independent codes and compared."""
