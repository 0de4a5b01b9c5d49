"""Linear models of a compiled model: derivatives, independent states, equilibria, eigenvalues and
stability."""
