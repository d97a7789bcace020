"""All combinations of law, mode, points, path, reversibility and kinematics: which there are, and what holds of each."""
