"""The quantity types that are there without being declared, and the constants."""

from __future__ import annotations

import math

from lagc.base.records import dataclass
from lagc.semantics.types.units import NONE, Dimension, si_text, unit


@dataclass(frozen=True, slots=True)
class QuantityType:
    """A kind of quantity: the unit its bare numbers are in, and the one people read it in."""

    name: str
    unit: str
    display: str
    dimension: Dimension

    @property
    def said(self) -> str:
        """In words: `Torque [N.m]`, `a number`."""
        known = TYPES.get(self.name)
        if known is None or known.dimension == NONE or known.dimension != self.dimension:
            return describe(self.dimension)
        return f"{self.name} [{self.unit}]"


def quantity_type(name: str, si: str, display: str | None = None) -> QuantityType:
    return QuantityType(name, si, display or si, unit(si or "1").dimension)


_TABLE: dict[str, tuple[str, ...]] = {
    "Real": ("",), "Integer": ("",),
    "Mass": ("kg",), "Length": ("m",), "Time": ("s",), "Angle": ("rad", "deg"), "Area": ("m2",),
    "Volume": ("m3",),
    "Velocity": ("m/s",), "AngularVelocity": ("rad/s",), "Acceleration": ("m/s2",),
    "AngularAcceleration": ("rad/s2",), "Force": ("N",), "Energy": ("J",), "Torque": ("N.m",),
    "Power": ("W",),
    "Action": ("J.s",), "Inertia": ("kg.m2",), "Momentum": ("kg.m/s",), "AngularMomentum": ("kg.m2/s",),
    "Stiffness": ("N/m",), "RotationalStiffness": ("N.m/rad",), "Damping": ("N.s/m",),
    "RotationalDamping": ("N.m.s/rad",), "Pressure": ("Pa",), "Density": ("kg/m3",),
    "LinearDensity": ("kg/m",), "AreaDensity": ("kg/m2",), "Frequency": ("Hz",), "Charge": ("C",),
    "Current": ("A",), "Voltage": ("V",), "MagneticField": ("T",), "ElectricField": ("V/m",),
    "Temperature": ("K",), "Curvature": ("1/m",), "Viscosity": ("Pa.s",),
}  # fmt: skip

TYPES: dict[str, QuantityType] = {name: quantity_type(name, *row) for name, row in _TABLE.items()}

CONSTANTS: dict[str, float] = {"pi": math.pi}

_BY_DIMENSION: dict[Dimension, str] = {}
for _type in TYPES.values():
    _BY_DIMENSION.setdefault(_type.dimension, _type.name)
_BY_DIMENSION[NONE] = "a number"


def describe(dimension: Dimension) -> str:
    """A dimension in words: `Length [m]`, `[kg.m/s3]`, `a number`."""
    name = _BY_DIMENSION.get(dimension)
    if dimension == NONE:
        return "a number"
    return f"{name} [{TYPES[name].unit}]" if name else f"[{si_text(dimension)}]"
