"""The study of any key: how curve, energies, steps, time and memory change with its values."""
