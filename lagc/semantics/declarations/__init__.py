"""The declarations of a model: quantities, bodies, orientations, actions, events."""
