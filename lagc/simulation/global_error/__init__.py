"""The estimate of the global error of a run."""
