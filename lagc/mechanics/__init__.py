"""Equations of motion by the principle of virtual power.

In: `Model`. Out: `EquationsOfMotion`, M a + h = tau + G^T lam with rows, contributions and energies;
`Analysis`, the properties for `lagc explain`.
"""
