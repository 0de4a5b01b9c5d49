"""Integrators: step size control, error norm, Runge-Kutta methods."""
