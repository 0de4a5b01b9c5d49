"""Questions at states of the constraints: samples, ranks, zero tests of expressions."""
