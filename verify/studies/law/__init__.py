"""A user's traction law compared with the definition, at one point: paths, tractions, checks, defects."""
