"""What generated Python modules are made of besides their functions: statuses, the solution of the
linear equations, integrators, projection.

Each file is part of generated modules from its marker on, and importable here, where the runner
uses it for any `Problem`.  Every file has a twin in C (`lagc/render/c/support`) with the same
operations in the same order: both give the same bits.
"""
