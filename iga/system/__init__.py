"""From a state to forces, energies and the tangent."""
