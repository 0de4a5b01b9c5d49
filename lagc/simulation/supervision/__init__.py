"""The progress of a run, watched."""
