"""Integration of any `Problem` in Python: the driver of generated modules, on hand-written systems too.

A compiled model integrates itself (`System.integrate`), in C or with the same text in its module.
"""

from __future__ import annotations

from lagc.render.numpy.support.integrate import METHODS, Integrator, Method
from lagc.render.numpy.support.projection import project
from lagc.render.numpy.support.record import integrate

__all__ = ["METHODS", "Integrator", "Method", "integrate", "project"]
