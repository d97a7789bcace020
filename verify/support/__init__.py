"""Messages, progress, refusals, timing, files with a checked layout."""
