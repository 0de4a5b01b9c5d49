"""Code generation: print a Program as C99 or as a Python module.

A generated file holds the functions of the model, printed from the Program, and the kernels that it calls
(`lagc.kernels`), printed by `kernel_compiler`.
"""
