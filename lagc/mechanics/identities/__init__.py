"""Zero tests of expressions on the constraint manifold."""
