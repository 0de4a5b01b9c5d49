"""Dense factorizations and rank."""
