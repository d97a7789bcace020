"""Following the equilibrium path: control, Newton, step length."""
