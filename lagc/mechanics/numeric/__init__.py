"""Numerical tools of the derivation: samples, linear algebra, roots."""
