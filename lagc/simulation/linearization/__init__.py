"""Equilibria and linear models."""
