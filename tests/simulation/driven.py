"""Models with inputs, and one way to step them in C and in Python."""

import ctypes
from ctypes import c_double, c_int, c_long, c_size_t
from functools import cache
from typing import Any

import lagc
from lagc.codegen.identifiers import prefix
from lagc.simulation.backends.compile import library
from lagc.simulation.system import Options, System

_GRAVITY = "  effect gravity\n    Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});\n  end gravity;\n"
_SCENE = "  scene s uses gravity\n    simulate(stop = 1 [s]);\n  end s;\n"
MODELS = {
    "Cart": f"""model Cart
  parameter Mass M = 1 [kg], m = 0.3 [kg];
  parameter Length l = 0.5 [m];
  input Force u = 0;
  input Torque c = 0;
  coordinate Length x(rate = 0.1);
  coordinate Angle theta(start = 10 [deg]);
  body cart = Particle(mass = M, at = {{x, 0, 0}});
  body bob = Particle(mass = m, at = {{x + l*sin(theta), 0, l*cos(theta)}});
  potential held = 2 [N/m]*x^2 - c*theta;
  dissipation rail = 0.2 [N.s/m]*der(x)^2;
  force drive = u*world.x at cart;
{_GRAVITY}{_SCENE}  output Energy E = energy();
end Cart;
""",
    "Rod": f"""model Rod
  parameter Mass m = 0.7 [kg];
  parameter Length l = 0.8 [m];
  input Force u = 0, w = 0;
  coordinate Length x(start = 0.3), z(start = -0.7);
  body bob = Particle(mass = m, at = {{x, 0, z}});
  constraint rod: x^2 + z^2 = l^2;
  force drive = {{u, 0, w}} at bob;
{_GRAVITY}{_SCENE}  output Real[N/m] tension = -reaction(rod);
end Rod;
""",
    "Top": f"""model Top
  parameter Inertia I1 = 0.3 [kg.m2], I2 = 0.5 [kg.m2], I3 = 0.7 [kg.m2];
  input Torque u = 0, w = 0;
  coordinate Orientation o(rate = {{0.5, 1.5, -0.4}} [rad/s]);
  frame B = rotate(world, o);
  body top = Solid(mass = 1 [kg], inertia = {{I1, I2, I3}}, frame = B, com = 0.2 [m]*B.y);
  torque turn = u*world.z + w*B.x on top;
{_GRAVITY}{_SCENE}end Top;
""",
}


@cache
def model(name: str, backend: str) -> lagc.CompiledModel:
    return lagc.loads(MODELS[name], f"{name}.lag").compile(backend=backend)


def consistent(name: str, system: System) -> list[float]:
    """A start of `system` on its constraints."""
    x = [float(a) for a in model(name, "numpy").start()]
    return x + [0.0] * (system.nx - len(x))


def taking(system: Any, options: Options) -> Any:
    """The system whose code has the method of `options`."""
    return system.compiled.for_method(options.method, system.parameters) or system


class InPython:
    """The generated module's equations; `work` is the equations that several states may share."""

    def __init__(self, system: Any, options: Options, t: float, x: list[float], work: Any = None):
        system = taking(system, options)
        self.work = system.equations() if work is None else work
        self.p: list[float] = list(system.parameters)
        self.nc = system.nc
        self.run = system.model.module["Integrator"](self.work, options, t, x)

    def _with_p(self) -> None:
        self.work.p[: len(self.p)] = self.p
        self.work.bind()

    def step(self, t1: float) -> int:
        self._with_p()
        return self.run.step(t1)

    def advance(self, t1: float) -> int:
        self._with_p()
        return self.run.advance(t1)

    def dense(self, t: float) -> list[float]:
        self._with_p()
        return self.run.at(t)[1]

    def disturb(self, x: list[float]) -> None:
        """Use the workspace for something else."""
        self.work.rhs(0.3, x, [0.0] * len(x), [0.0] * self.nc)

    def put(self, t: float, x: list[float]) -> None:
        self.run.t, self.run.x = t, list(x)

    def facts(self) -> tuple[Any, ...]:
        r = self.run
        return (r.t, r.x[:], r.t_old, r.steps, r.rejected, r.rhs, r.position_drift, r.velocity_drift)

    def limit(self, steps: int) -> None:
        self.run.options.max_steps = steps

    def longest(self, step: float) -> None:
        self.run.options.max_step = step


class InC:
    """The functions of the header."""

    def __init__(self, system: Any, options: Options, t: float, x: list[float], work: Any = None):
        system = taking(system, options)
        self.library = library(system.model.sources)
        self.prefix, self.nx, self.nc = prefix(system.interface.model), system.nx, system.nc
        self.work = system.model.work() if work is None else work
        self.p, self.prepared = list(system.parameters), system.interface.prepared
        self.room = ctypes.create_string_buffer(self._call("state_size", c_size_t))
        self.state = system.model.state.from_buffer(self.room)
        self.options = system.model.options(options)
        self._call("begin", None, self.room, c_double(t), (c_double * self.nx)(*x))

    def _call(self, name: str, result: Any, *given: Any) -> Any:
        function = getattr(self.library, f"{self.prefix}_{name}")
        function.restype = result
        return function(*given)

    def _bound(self) -> Any:
        p = (c_double * max(len(self.p) + self.prepared, 1))(*self.p)
        if self.prepared:
            self._call("bind", None, p)
        return p

    def step(self, t1: float) -> int:
        return int(
            self._call(
                "step", c_int, self._bound(), self.room, c_double(t1), ctypes.byref(self.options), self.work
            )
        )

    def advance(self, t1: float) -> int:
        return int(
            self._call(
                "advance",
                c_int,
                self._bound(),
                self.room,
                c_double(t1),
                ctypes.byref(self.options),
                self.work,
            )
        )

    def dense(self, t: float) -> list[float]:
        x = (c_double * self.nx)()
        self._call(
            "dense", c_int, self._bound(), self.room, c_double(t), ctypes.byref(self.options), x, self.work
        )
        return x[:]

    def record(self, times: list[float], budget: int) -> list[list[float]]:
        """To the last of `times` in calls of at most `budget` steps."""
        n, done = len(times), c_size_t(0)
        grid, states = (c_double * n)(*times), (c_double * (n * self.nx))()
        where = (grid, c_size_t(n), states, ctypes.byref(done))
        given = (self._bound(), self.room, ctypes.byref(self.options), *where, c_long(budget), self.work)
        while self._call("record", c_int, *given):
            pass
        return [states[k : k + self.nx] for k in range(0, n * self.nx, self.nx)]

    def disturb(self, x: list[float]) -> None:
        rates, lam = (c_double * self.nx)(), (c_double * max(self.nc, 1))()
        self._call(
            "rhs", c_int, self._bound(), c_double(0.3), (c_double * self.nx)(*x), rates, lam, self.work
        )

    def put(self, t: float, x: list[float]) -> None:
        self.state.t = t
        self.state.x[:] = x

    def facts(self) -> tuple[Any, ...]:
        s = self.state
        return (s.t, s.x[:], s.t_old, s.steps, s.rejected, s.rhs, s.position_drift, s.velocity_drift)

    def limit(self, steps: int) -> None:
        self.options.max_steps = steps

    def longest(self, step: float) -> None:
        self.options.max_step = step


def stepper(name: str, backend: str, options: Options, work: Any = None) -> Any:
    """A state of the model `name` on its way from its start."""
    system = model(name, backend).load(backend)
    return stepper_of(system, options, consistent(name, system), work)


def stepper_of(system: System, options: Options, x: list[float], work: Any = None) -> Any:
    kind = InC if system.backend == "c" else InPython
    return kind(system, Options(**vars(options)), 0.0, x, work)
