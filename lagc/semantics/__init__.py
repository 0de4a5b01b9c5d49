"""Names, dimensions and instances.

In: `Tree`, and the choice of a scene.  Out: `Model`: frames, points, bodies, actions and constraints, in
SI, as expressions of coordinates and rates.
"""
