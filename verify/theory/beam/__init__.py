"""The cohesive beam, solved to rounding."""
