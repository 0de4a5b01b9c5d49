"""Sensitivities: the variational equations along the steps of a motion."""
