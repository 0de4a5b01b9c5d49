"""Generalized forces, the energy balance, and outputs."""
