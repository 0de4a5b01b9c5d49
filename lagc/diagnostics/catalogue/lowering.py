"""LAG05xx: what shows when the equations are prepared for being solved."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

_SPRINGS = """\
model M
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 10 [N/m];
  coordinate Length x, y;
  body p = Particle(mass = m, at = {x, 0, 0});
"""

ENTRIES: dict[str, Entry] = {
    "LAG0501": Entry(
        "a coordinate that moves no mass",
        "The acceleration of a coordinate is found from the inertia that moves with it.  Forces or "
        "outputs speak of this one, but no body moves with it, and no constraint ties it to another "
        "that has inertia or gives its rate, as `der(y) = x/T` does.  A coordinate that nothing at all "
        "speaks of is left out, without a fault.",
        f"{_SPRINGS}  potential spring = 1/2*k*(y - x)^2;\nend M;\n",
        f"{_SPRINGS}  body r = Particle(mass = m, at = {{y, 0, 0}});\n"
        "  potential spring = 1/2*k*(y - x)^2;\nend M;\n",
    ),
    "LAG0590": Entry(
        "a number of the equations is too large",
        "A coefficient that came up while the equations were derived exceeds the largest number that "
        "a double can hold, 1.8e308.  Choose units in which the constants of the model are of "
        "moderate size.",
    ),
}
