"""Following the equilibrium path in DOLFINx."""
