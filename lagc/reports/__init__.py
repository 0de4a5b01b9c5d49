"""Equations, worked solutions, explanations and pictures for people.

In: `EquationsOfMotion`, `Program` or `Solution`.  Out: text, LaTeX, a SymPy script, HTML, a figure.
"""
