"""Methods by name: the problem that each solver is given, and its result."""
