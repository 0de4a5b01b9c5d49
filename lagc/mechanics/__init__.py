"""Equations of motion by the principle of virtual power.

In: `Model`.  Out: `EquationsOfMotion`: M a + h = tau + G^T lam with its rows, contributions and energies;
and `Analysis`, for what people ask of a system.
"""
