"""The formulation: states, inertia, constraints and the equations of motion."""
