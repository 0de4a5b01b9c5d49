"""The pipeline of stages, from a model file to a compiled artifact."""
