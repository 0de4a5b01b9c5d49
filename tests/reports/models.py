"""Models of the library, as the tests of this room use them."""

from functools import cache
from pathlib import Path

from lagc.compiler.stages import Choice, derive, parse, resolve
from lagc.diagnostics.faults import Source
from lagc.mechanics.formulation.equations import EquationsOfMotion

MODELS = Path(__file__).parents[2] / "models"


@cache
def derived(name: str, scene: str | None = None) -> EquationsOfMotion:
    """The equations of `course/simple_pendulum`, or of any other file of the library."""
    path = MODELS / f"{name}.lag"
    return equations_of(path.read_text(encoding="utf-8"), path.name, scene)


def equations_of(text: str, name: str = "test.lag", scene: str | None = None) -> EquationsOfMotion:
    return derive(resolve(parse(Source(name, text)), Choice(scene=scene)))


LONG = """
model Long
  structural Integer n = 24;
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Length x[n](each start = 0.1 [m]);
  potential V = 1 [J]*({total})^5;
  for i in 1:n loop
    body b[i] = Particle(mass = m, at = {x[i], 0, 0});
  end for;
end Long;
""".replace("{total}", " + ".join([f"x[{i}]/l" for i in range(1, 25)]))

EVERYTHING = """
model Everything
  parameter Mass m = 1 [kg];
  parameter Real a = 2;
  parameter Stiffness k = 3 [N/m];
  coordinate Real x(start = 0.3), y(start = 0.4);
  lagrangian L = 1 [J]*(1/2*der(x)^2 + 1/2*der(y)^2)*1 [s2];
  potential V = 1 [J]*(exp(-x^2) + log(2 + y^2) + atan2(y, 2 + x^2) + abs(x)^3 + max(x, y) + tanh(x*y)
    + (2 + x^2)^a + 1/(1 + x^2 + y^2)^2 + (if x < y then x^2 else y^2) + sqrt(1 + x^2)*cosh(y) + asin(x/5));
end Everything;
"""


def rows(latex: str) -> list[str]:
    """The equations of a text in LaTeX, each alone."""
    body = latex.partition("\\begin{align*}\n")[2].partition("\n\\end{align*}")[0]
    return [line.strip().removesuffix("\\\\").replace("&", "") for line in body.splitlines()]
