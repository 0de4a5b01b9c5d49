"""The linear system of accelerations and multipliers: ordering, factorization, solution."""
