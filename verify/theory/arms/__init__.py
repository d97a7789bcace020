"""Two shear-flexible arms on a bond that opens and slides: the cohesive beam in mixed mode, and its brittle limit."""
