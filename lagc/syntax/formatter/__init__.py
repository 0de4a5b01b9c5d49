"""The formatter of model files."""
