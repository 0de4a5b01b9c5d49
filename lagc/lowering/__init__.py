"""Equations to operations.

In: `EquationsOfMotion`.  Out: `Program`: straight-line functions of binary operations in a fixed order,
the last form without a target.
"""
