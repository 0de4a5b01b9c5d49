"""No text and no failing file makes lagc stumble.  In full: `python -m tests.fuzz --hours N`."""

import os
import random
import re
import shutil
import signal
import string
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytest.importorskip("resource")

from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused, Source
from lagc.simulation.backends import compile as compiled
from tests.fuzz import workers
from tests.fuzz.__main__ import KINDS, Trials, main
from tests.fuzz.commands import Said, call, complaint
from tests.fuzz.findings import minimised
from tests.fuzz.grammar import rules
from tests.fuzz.interference import same
from tests.fuzz.mechanisms import RULES, mechanism
from tests.fuzz.models import Case, model
from tests.fuzz.mutations import library, mutated
from tests.fuzz.statements import spliced

COUNT = int(os.environ.get("LAGC_FUZZ", "8"))  # texts of each kind
SLOW = {"models": 2, "mechanisms": 4, "guided": 2}  # of which there are that many times fewer
CORPUS = sorted((Path(__file__).parent / "corpus").glob("*.lag"))
UNUSED = {"annotation"}  # are read, and not yet of the language


@pytest.fixture(scope="module", autouse=True)
def no_compiler_is_left_behind() -> Iterator[None]:
    yield
    compiled.compiler.cache_clear()


@pytest.fixture(scope="module")
def trials(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Trials]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LAGC_CC", "")
        patch.setenv("LAGC_CACHE", "")
        yield Trials(tmp_path_factory.mktemp("fuzz"), compiled=0.0, jobs=1)


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_stumbles(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if kind == "disturbed" and not (sys.platform == "linux" and shutil.which("cc")):
        pytest.skip("calls are disturbed by a library that is loaded before that of C")
    monkeypatch.setenv("LAGC_CC", os.environ.get("LAGC_CC", ""))  # is set by the trials
    monkeypatch.setenv("LAGC_CACHE", "")
    count = -(-COUNT // SLOW.get(kind, 1))
    words = ["--kinds", kind, "--texts", str(count), "--jobs", "1", "-o", str(tmp_path)]
    assert main(words) == 0


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_what_was_found_once_is_mended(path: Path, trials: Trials) -> None:
    assert trials.stumbles(Case(path.read_text(encoding="utf-8")), 0) == []


@pytest.mark.sample(4, 20)
@pytest.mark.parametrize("seed", range(100))
def test_a_mechanism_is_checked(seed: int) -> None:
    assert complaint(("check", "-"), call("check", "-", stdin=mechanism(seed).text)) is None


@pytest.mark.sample(0, 8)
@pytest.mark.parametrize("seed", range(100))
def test_a_mechanism_passes_through_all_commands(seed: int, trials: Trials) -> None:
    assert trials.stumbles(mechanism(seed), seed) == []


@pytest.mark.full
@pytest.mark.parametrize("seed", range(10))
def test_noise_is_refused(seed: int, trials: Trials) -> None:
    chance = random.Random(seed)
    text = "".join(chance.choice(string.printable + "é\u2028\0") for _ in range(chance.randrange(1, 400)))
    assert trials.stumbles(Case(text), seed) == []


@pytest.mark.sample(0, 3)
@pytest.mark.parametrize(
    "text",
    [
        "", "\ufeff", "model M", "/*" * 1000, "(" * 100_000,
        "model M coordinate Length x; potential V = " + "(" * 5000 + "x" + ")" * 5000 + "; end M;",
        "model M coordinate Length x; potential V = 1 [J]" + " + 1 [J]" * 20_000 + "; end M;",
        "model M coordinate Length x; parameter Real k = " + "-" * 20_000 + "1; end M;",
        "model M coordinate Length x; parameter Real k = 2^999999999; end M;",
        "model M coordinate Length x; parameter Real k = " + "9" * 5000 + "; end M;",
        "model M coordinate Length x[" + "9" * 30 + "]; end M;", "model " + "M" * 100_000 + " end M;",
        "package P " * 3000, "effect e " * 3000,
        "model M for i in 1:99999 loop for j in 1:99999 loop point P[i,j] = {0,0,0};",
        "model A B b; end A; model B A a; end B;", "model M extends M; end M;",
        "model M function f(Real u) = g(u) + g(u); function g(Real u) = f(u) + f(u); coordinate Length x;"
        "potential V = f(1)*1 [J]; end M;",
        "model M function f0(Real u) = u + u;"
        + "".join(f"function f{k}(Real u) = f{k - 1}(u) + f{k - 1}(u);" for k in range(1, 60))
        + "coordinate Length x; potential V = f59(x/1 [m])*1 [J]; end M;",
        "model M "
        + "".join(f"parameter Real p{k} = p{k + 1};" for k in range(5000))
        + " parameter Real p5000 = 1; end M;",
    ],
    ids=range(20),
)  # fmt: skip
def test_a_wicked_text_is_answered(text: str, trials: Trials) -> None:
    assert trials.stumbles(Case(text), 0) == []


def test_texts_are_made_by_their_seed() -> None:
    texts = library()
    for make in (lambda seed: mutated(texts, seed), lambda seed: spliced(texts, seed), model, mechanism):
        assert make(7) == make(7) != make(8)


@pytest.mark.full
@pytest.mark.parametrize("make", [model, mechanism])
def test_most_models_are_sound(make: Callable[[int], Case]) -> None:
    sound, cases = 0, [case for case in map(make, range(100)) if not case.files]
    for case in cases:
        try:
            pipeline.derive(pipeline.resolve(pipeline.parse(Source("text", case.text)), pipeline.Choice()))
            sound += 1
        except Refused:
            pass
    assert sound > 0.6 * len(cases)


@pytest.mark.full
def test_models_use_the_whole_grammar_and_mechanisms_all_texts() -> None:
    used = rules(model(seed).text for seed in range(400))
    assert {rule for rule, count in used.items() if not count} <= UNUSED
    whole = "".join(mechanism(seed).text for seed in range(1000))
    for text in (*RULES["placed"], *RULES["carried"], *RULES["parts"], *RULES["actions"]):
        assert re.split("[#<\n]", text)[0] in whole


def _spin() -> None:
    while True:
        pass


def _fill() -> None:
    hoard = [bytearray(workers.MEMORY + (1 << 28))]
    del hoard


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize(
    ("act", "how"),
    [
        (_spin, "more than"),
        (lambda: os.kill(os.getpid(), signal.SIGUSR1), "SIGUSR1"),
        (_fill, "exit code 1"),
        (lambda: time.sleep(60), "killed"),
        (lambda: os._exit(3), "exit code 3"),
    ],
)
def test_a_task_that_does_not_end_is_told_and_the_others_go_on(
    act: Callable[[], None], how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "SECONDS", 0)
    monkeypatch.setattr(workers, "WALL", 4.0)

    def do(task: int, tell: Callable[[str], None]) -> int:
        tell(f"command {task}")
        if task == 1:
            act()
        return task

    found = dict(workers.run(do, range(4), 1))
    assert [found[k] for k in (0, 2, 3)] == [0, 2, 3]
    assert isinstance(found[1], workers.Died)
    assert found[1].command == "command 1" and how in found[1].how


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("check a", Said(0, "", "Traceback (most recent call last):")),
        ("check a", Said(70, "", "error[LAG0799]: internal error")), ("check a", Said(5, "", "lagc: no")),
        ("explain a", Said(3, "", "error[LAG0620]: no")), ("check a", Said(1, "", "")),
        ("check a", Said(2, "", "")), ("explain a", Said(0, "\x1b[31m", "")),
        ("sim a --json", Said(0, '{"status": "failed"}', "")), ("sim a --json", Said(3, "half of it", "")),
    ],
)  # fmt: skip
def test_answers_that_break_the_contract_are_seen(words: str, said: Said) -> None:
    assert complaint(tuple(words.split()), said)
    assert not complaint(("check", "a"), Said(1, "error[LAG0101]: no", ""))


def test_files_that_are_not_whole_are_seen() -> None:
    assert same("a.csv", b"1", b"1") and not same("a.csv", b"1", b"12") and not same("a.csv", None, b"")
    assert not same("a.svg", b"<svg>", b"<svg></svg>") and not same("a.npz", b"PK", b"PK3")


def test_what_was_found_is_made_small() -> None:
    text = "".join(f"  parameter Real p{k} = {k};\n" for k in range(20))
    case = Case(f"model M\n{text}end M;\n", options=("-p", "a=1"))
    small = minimised(case, lambda c: "p7 " in c.text)
    assert small == Case("  parameter Real p7 = 7;\n")
