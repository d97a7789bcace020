"""Shape functions at points, kinematics, elasticity, element matrices."""
