"""Messages, progress, refusals, timing, checked files."""
