"""Robots of other tools, URDF and MJCF, as models: `lagc import`."""
