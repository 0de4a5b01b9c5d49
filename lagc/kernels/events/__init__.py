"""Events: location, modes, mode changes, when clauses."""
