"""What all specimens share: problem, pose, bodies, bond, load."""
