"""Plots of trajectories and mode shapes."""
