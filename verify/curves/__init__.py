"""Load curves: reading, sampling, comparing."""
