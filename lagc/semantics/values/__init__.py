"""Values: evaluation of expressions, calls, frame vectors, tables."""
