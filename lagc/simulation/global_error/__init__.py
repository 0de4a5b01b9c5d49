"""The global error of a run: truncation, round-off, and the energy balance."""
