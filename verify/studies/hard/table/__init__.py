"""All combinations of law, mode, points, path, reversibility and kinematics, and what holds of each."""
