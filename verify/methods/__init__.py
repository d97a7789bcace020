"""Methods by name: the problem that each solver gets, and its result."""
