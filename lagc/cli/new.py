"""Write a model to start from, NAME.lag, valid, formatted and commented; or list the library models."""

import argparse
import os
import re

from lagc.cli.output import DONE, Usage, cannot_write, say, show
from lagc.cli.signals import SIGNALS
from lagc.host import atomic_write, model_library

TEMPLATE = """\
model {name} "A mass on a massless string"
  // Parameters, with units.  `-p l=0.7` changes one without compiling again.
  parameter Mass m(min = 0) = 1 [kg];
  parameter Length l(min = 0) = 0.5 [m] "string length";

  // The coordinates describe every configuration of the system.
  coordinate Angle theta(start = 60 [deg]) "from the downward vertical";

  // Positions as functions of the coordinates.
  body bob = Particle(mass = m, at = l*{{sin(theta), 0, -cos(theta)}});

  // The compiler leaves out an effect that the scene does not use.
  effect gravity
    Gravity field(g = 9.81 [m/s2], direction = {{0, 0, -1}});
  end gravity;

  effect air "quadratic drag"
    parameter Real[kg/m] k = 1e-3;
    force drag = -k*norm(velocity(bob))*velocity(bob) at bob;
  end air;

  scene vacuum uses gravity
    simulate(stop = 10 [s]);
  end vacuum;

  scene room uses gravity, air
    simulate(stop = 10 [s]);
  end room;

  output Energy E = energy();
end {name};
"""

JSON = False  # no option `--json`


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "name", metavar="NAME", nargs="?",
        help="the name of the model, such as `Pendulum`, or a path such as `models/Pendulum`",
    )  # fmt: skip
    parser.add_argument("--list", action="store_true", help="list the models of the library")
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(options: argparse.Namespace) -> int:
    if options.list:
        show(_listing())
        return DONE
    if options.name is None:
        raise Usage("NAME is missing; `lagc new --list` lists the models of the library")
    folder, base = os.path.split(options.name)
    base = base.removesuffix(".lag")
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", base):
        raise Usage(f"`{base}` cannot be the name of a model: letters, digits and _ only, a letter first")
    path = os.path.join(folder, f"{base}.lag")
    name = "".join(part[:1].upper() + part[1:] for part in base.split("_")) or base
    try:
        with SIGNALS.patience():
            atomic_write.write(path, TEMPLATE.format(name=name).encode(), fresh=not options.force)
    except FileExistsError:
        raise Usage(f"`{path}` exists already; --force replaces it") from None
    except OSError as error:
        raise cannot_write(path, error) from None
    say(f"{path} written; `lagc sim {path}` simulates it", options.quiet)
    return DONE


def _listing() -> str:
    """Return one line for each model of the library, with the description of the last model in its file."""
    models = model_library.library_models()
    width = max(map(len, models), default=0)
    found = []
    for name in models:
        described = re.findall(r'^model \w+ "(.*)"', model_library.read(name).text, re.MULTILINE)
        found.append(f"{name:{width}}  {described[-1] if described else ''}".rstrip() + "\n")
    return "".join(found)
