"""Runs in processes of their own, in folders, kept by hash."""
