"""One compiled model in many threads: the answers of one thread alone, bit for bit."""

import gc
import random
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from threading import Barrier, Thread
from typing import Any

import pytest

import lagc
from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice, render
from lagc.host import cache
from lagc.host.model_library import read
from lagc.simulation.backends import compile as c_compiler
from lagc.simulation.backends import load
from lagc.simulation.system import Options, System
from tests.simulation.programs import BACKENDS, NAMES, built

MODELS = ["double_pendulum", "classic/four_bar", "classic/heavy_top_quaternion", "classic/rolling_disc"]


@pytest.fixture(autouse=True)
def hurry() -> Iterator[None]:
    """Threads take turns every few microseconds."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(2e-6)
    yield
    sys.setswitchinterval(before)


def together(tasks: list[Callable[[], Any]]) -> list[Any]:
    """What the tasks give, each in a thread of its own, all begun at the same time."""
    barrier = Barrier(len(tasks))
    found: list[Any] = [None] * len(tasks)

    def run(i: int) -> None:
        barrier.wait()
        try:
            found[i] = tasks[i]()
        except BaseException as error:
            found[i] = error

    threads = [Thread(target=run, args=(i,)) for i in range(len(tasks))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


def ask(system: System, dice: random.Random, x: list[float]) -> str:
    """One question about a state near `x`."""
    t = dice.uniform(0.0, 1.0)
    state = [a + 0.01 * dice.gauss(0.0, 1.0) for a in x]
    rates, lam = [0.0] * system.nx, [0.0] * system.nc
    what = dice.choice(["rhs", "rhs", "outputs", "energies", "solve", "start", "accelerations"])
    if what == "rhs":
        return repr((system.rhs(t, state, rates, lam), rates, lam))
    if what == "solve" and system.nc:
        status = system.assemble(t, state)
        system.energies(t, state)
        return repr((status, system.solve([dice.gauss(0.0, 1.0) for _ in range(system.nv + system.nc)])))
    if what in ("start", "solve"):
        return repr(system.start())
    return repr(getattr(system, what)(t, state))


def questions(systems: list[System], seed: int, count: int) -> list[str]:
    dice = random.Random(seed)
    found = []
    for _ in range(count):
        system = dice.choice(systems)
        found.append(ask(system, dice, system.start()))
    return found


@pytest.mark.sample(1)
@BACKENDS
@pytest.mark.parametrize("name", MODELS)
def test_many_threads_ask_one_model(name: str, backend: str) -> None:
    """Systems of one model with parameters of their own, asked in turn by every thread."""
    model = lagc.load(name).compile(backend=backend)
    dice = random.Random(name)
    own = model.load(backend)
    values = [[v * dice.uniform(0.9, 1.1) for v in own.parameters] for _ in range(3)]
    systems = [own, *(own.bind(v) for v in values)]
    count, asked = dice.randint(4, 12), 1000 if backend == "c" else 250
    alone = [questions(systems, seed, asked) for seed in range(count)]
    assert together([partial(questions, systems, s, asked) for s in range(count)]) == alone


@pytest.mark.sample(1)
@BACKENDS
def test_many_threads_simulate_one_model(backend: str) -> None:
    """Each with parameters of its own; columns are computed while others run."""
    model = lagc.load("simple_pendulum").compile(scene="room", backend=backend)
    dice = random.Random(backend)
    lengths = [dice.uniform(0.2, 2.0) for _ in range(dice.randint(5, 9))]

    def one(model: lagc.CompiledModel, length: float) -> str:
        run = model.simulate(stop=0.5, accuracy=1e-7, points=5, parameters={"l": length})
        at = (
            model.rhs(0.1, [0.3, 0.2], {"l": length}).tolist(),
            model.bind({"l": length}).rhs(0, [0.3, 0.2]).tolist(),
        )
        return repr((run.states, run["E"].tolist(), run["der(theta)"].tolist(), run.parameters, at))

    fresh = lagc.load("simple_pendulum").compile(scene="room", backend=backend)
    alone = [one(fresh, length) for length in lengths]
    assert len(set(alone)) == len(lengths)
    assert together([partial(one, model, a) for a in lengths]) == alone


@pytest.mark.sample(1)
@BACKENDS
def test_a_run_keeps_its_parameters(backend: str) -> None:
    model = lagc.load("simple_pendulum").compile(scene="vacuum", backend=backend)
    bound = model.bind({"l": 0.7, "m": (200, "g")})
    first = bound.simulate(stop=0.5, accuracy=1e-8)
    model.simulate(stop=0.5, parameters={"l": 3.0})
    bound.rhs(0.0, [0.1, 0.2], {"l": 9.0})
    again = model.simulate(stop=0.5, accuracy=1e-8, parameters={"l": 0.7, "m": 0.2})
    assert first["E"].tolist() == again["E"].tolist() and first.parameters == again.parameters
    assert model.rhs(0.0, [0.1, 0.2]).tolist() != bound.rhs(0.0, [0.1, 0.2]).tolist()
    assert bound.bind({"l": 0.5}).system.parameters != bound.system.parameters
    with pytest.raises(lagc.Refused):
        model.bind({"L": 1.0})
    with pytest.raises(ValueError, match="entries"):
        model.system.bind([1.0])
    with pytest.raises(AttributeError):
        bound.system.parameters = [1.0]


@pytest.mark.sample(6)
@BACKENDS
@pytest.mark.parametrize("name", NAMES)
def test_an_answer_depends_on_the_question_alone(name: str, backend: str) -> None:
    """Not on what was asked before: rows found to be dependent are no business of the next caller."""
    system = built(name, backend)
    x, dice = system.start(), random.Random(1)
    others = [[a + dice.gauss(0.0, 0.3) for a in x] for _ in range(4)]

    def answers() -> str:
        rates, lam = [0.0] * system.nx, [0.0] * system.nc
        return repr((system.rhs(0.0, x, rates, lam), rates, lam, system.outputs(0.0, x)))

    first = answers()
    for other in others:
        system.rhs(0.0, other, [0.0] * system.nx, [0.0] * system.nc)
        system.integrate(Options(rtol=1e-4, atol=1e-4, max_steps=20), 0.0, x, [0.0, 0.01])
        assert answers() == first


@pytest.mark.full
@pytest.mark.usefixtures("no_cache")
def test_many_threads_compile() -> None:
    """Several models, each more than once: the same text as from one thread."""
    names = ["double_pendulum", "classic/rolling_disc", "classic/four_bar", "classic/furuta_pendulum"]

    def texts(name: str) -> Any:
        program = Compilation(read(name), Choice()).program
        return render(program, "c"), render(program, "numpy")

    alone = {name: texts(name) for name in names}
    chosen = [*names, names[0], names[2]]
    for found, name in zip(together([partial(texts, n) for n in chosen]), chosen):
        assert found == alone[name]


@pytest.mark.usefixtures("no_cache")
def test_one_compilation_has_one_of_each_stage() -> None:
    compilation = Compilation(read("double_pendulum"), Choice())
    found = together([lambda: (compilation.program, compilation.equations, compilation.model)] * 4)
    assert all(a is b for stages in found for a, b in zip(stages, found[0]))
    assert found[0][1].graph is found[0][2].graph


@pytest.mark.usefixtures("no_cache")
@pytest.mark.parametrize("enabled", [True, False])
def test_collection_is_as_it_was(enabled: bool) -> None:
    before = gc.isenabled()
    try:
        (gc.enable if enabled else gc.disable)()
        together([lambda: Compilation(read("simple_pendulum"), Choice()).program] * 6)
        assert gc.isenabled() == enabled
    finally:
        (gc.enable if before else gc.disable)()


@pytest.mark.full
def test_many_threads_fill_one_entry_of_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader finds the whole entry, always."""
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    name, body = cache.key("entry"), bytes(range(256)) * 4000
    cache.store("entry", name, body)

    def write_and_read() -> int:
        wrong = 0
        for _ in range(20):
            cache.store("entry", name, body)
            wrong += cache.load("entry", name, bytes) != body
        return wrong

    assert together([write_and_read] * 6) == [0] * 6
    assert not list(tmp_path.glob("tmp-*"))


@pytest.mark.full
def test_many_threads_draw(tmp_path: Path) -> None:
    """The same picture as one thread draws, in the style that was set before."""
    matplotlib = pytest.importorskip("matplotlib")
    before = dict(matplotlib.rcParams)
    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(stop=0.5, points=20)

    def drawn(i: int) -> bytes:
        run.plot("theta", "E", path=str(tmp_path / f"{i}.svg"))
        return (tmp_path / f"{i}.svg").read_bytes()

    alone = drawn(0)
    assert together([partial(drawn, i) for i in range(1, 5)]) == [alone] * 4
    assert dict(matplotlib.rcParams) == before


@pytest.mark.full
@pytest.mark.skipif(c_compiler.compiler() is None, reason="there is no C compiler")
def test_many_threads_build_one_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    artifact = Compilation(read("simple_pendulum"), Choice()).artifact("c")

    def first_rate() -> str:
        system = load(artifact.interface, artifact.sources, "c")
        return repr(system.accelerations(0.0, system.start()))

    found = together([first_rate] * 4)
    assert len(set(found)) == 1 and found[0].startswith("(")
    assert not list(tmp_path.glob("tmp-*"))
