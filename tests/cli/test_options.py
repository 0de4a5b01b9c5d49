"""The words of a command line."""

import inspect
import random
import re
import time
from contextlib import suppress
from pathlib import Path

import pytest

from lagc.api import CompiledModel
from lagc.base.run_options import RUN_OPTIONS
from lagc.base.text import number, seconds, size
from lagc.cli.main import COMMANDS, main
from lagc.cli.options import assignments, quantity
from lagc.cli.output import Usage
from lagc.simulation.request import Request

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"


@pytest.mark.parametrize("name", RUN_OPTIONS)
def test_a_number_of_a_run_has_its_name_everywhere(name: str) -> None:
    option = RUN_OPTIONS[name]
    assert name in Request.__annotations__
    assert name in inspect.signature(CompiledModel.simulate).parameters
    assert f"`{name}`" in (REFERENCE / "python.md").read_text(encoding="utf-8")
    assert f"`{option.of_command} {option.form}`" in (REFERENCE / "commands.md").read_text(encoding="utf-8")
    language = (REFERENCE / "language.md").read_text(encoding="utf-8")
    (line,) = re.findall(r"^  simulate\(.*also .*", language, re.MULTILINE)
    assert re.search(rf"\b{option.of_scene}\b", line)


@pytest.mark.parametrize(
    "word, name, value, unit",
    [
        ("l=0.7", "l", 0.7, None),
        ("l=70[cm]", "l", 70.0, "cm"),
        ("l = -7e-1 [m]", "l", -0.7, "m"),
        ("a.b[2].m=3[kg]", "a.b[2].m", 3.0, "kg"),
        ("der(theta)=1 [rad/s]", "der(theta)", 1.0, "rad/s"),
        ("r=1[]", "r", 1.0, ""),
    ],
)
def test_an_assignment_is_read(word: str, name: str, value: float, unit: str | None) -> None:
    assert assignments([word], "-p") == {name: (value, unit)}


@pytest.mark.parametrize("word", ["l", "=1", "l=", "l=x", "l=1[m", "l=1]", "l=1 2", "l==2"])
def test_what_is_no_assignment_is_wrong_usage(word: str) -> None:
    with pytest.raises(Usage, match="name=value"):
        assignments([word], "-p")


FORM = re.compile(r"\s*([^=\s]+)\s*=\s*([^\[\]]+?)\s*(?:\[\s*([^\[\]]*?)\s*\])?\s*", re.ASCII)


@pytest.mark.full
def test_words_of_every_kind_are_read_as_the_form_says() -> None:
    chance, taken = random.Random(3), 0
    for _ in range(30_000):
        word = "".join(chance.choice("a=1[]. \t\N{NO-BREAK SPACE}") for _ in range(chance.randrange(1, 9)))
        word = chance.choice(("", "a=", "a=1", "a=1[")) + word
        match = FORM.fullmatch(word)
        value = number(match[2]) if match else None
        if match is None or value is None:
            with pytest.raises(Usage):
                assignments([word], "-p")
        else:
            taken += 1
            assert assignments([word], "-p") == {match[1]: (value, match[3])}, repr(word)
    assert taken > 1000


@pytest.mark.parametrize("long", [" ", "x ", "1", "1 ", "[", "]", "[ ", " ]", "=", "= ", "e", ".", "-", "m."])
def test_a_long_word_is_read_at_once(long: str) -> None:
    began = time.process_time()
    for before, after in [("", ""), ("a", ""), ("a=", ""), ("a=1", "x["), ("a=1[", ""), ("a=1[", "x"),
                          ("a", "=1"), ("a=", "1[m"), ("a=1[", "]"), (" ", "=")]:  # fmt: skip
        word = before + long * (100_000 // len(long)) + after
        with suppress(Usage):
            assignments([word], "-p")
        with suppress(Usage):
            quantity(word, "s", "--stop")
        assert seconds(word) is None and size(word) is None
    assert time.process_time() - began < 5.0  # a quadratic reader takes minutes


def test_every_command_has_help(capsys: pytest.CaptureFixture[str]) -> None:
    for name in COMMANDS:
        assert main([name, "--help"]) == 0
        assert "usage: lagc " + name in capsys.readouterr().out


def test_the_overview_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(f"  {name} " in shown for name in COMMANDS)


def test_an_unknown_option_is_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--nonsense"]) == 2
    assert "--nonsense" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [["--start", "theta=1", "--start", "theta=2"], ["-p", "l=1", "-p", "l=2"],
     ["--input", "u=1", "--input", "u=2"], ["--until", "theta > 1", "--until", "theta < 0"]],
)  # fmt: skip
def test_what_is_said_twice_is_not_chosen_from(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "simple_pendulum", *words]) == 2
    assert "twice" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["sim", "simple_pendulum", "-o", ""], ["linearize", "simple_pendulum", "-o", ""],
              ["sim", "simple_pendulum", "--until", " "], ["fmt", ""]],
)  # fmt: skip
def test_an_empty_word_is_none(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert capsys.readouterr().err.startswith("lagc: ")


@pytest.mark.parametrize(
    "words", [["--until", "q > 1"], ["--until", "theta >"], ["--input", "l=2*q"], ["--input", "l=none.csv"]]
)
def test_what_is_wrong_in_a_command_is_not_the_model(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sim", "simple_pendulum", *words]) == 2
    assert " --> <" in capsys.readouterr().err


def test_what_a_run_reads_it_does_not_write_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "m.lag").write_text(
        "model M input Force u = 0; coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0});"
        'force f = {u + 1 [N]*table(time, "own.csv"), 0, 0} at b; end M;'
    )
    numbers = "time,u\n0,1\n1,2\n"
    for name in ("own.csv", "drive.csv", "other.csv"):
        (tmp_path / name).write_text(numbers)
    (tmp_path / "link.csv").symlink_to("drive.csv")
    (tmp_path / "inner").mkdir()
    monkeypatch.chdir(tmp_path)
    sim = ["sim", "m.lag", "-q", "--stop", "1", "--input", "u=drive.csv:u", "-o"]
    for _ in range(2):  # the second time it was compiled before
        for name in ("own.csv", "drive.csv", "link.csv", str(tmp_path / "inner" / ".." / "own.csv")):
            assert main([*sim, name]) == 2
        assert (tmp_path / "own.csv").read_text() == (tmp_path / "drive.csv").read_text() == numbers
    assert main([*sim, "other.csv"]) == 0 and (tmp_path / "other.csv").read_text() != numbers


@pytest.mark.parametrize(
    ("file", "command"),
    [
        ("m.csv", "sim m.csv -o m.csv"),
        ("m.lag", "sim m.lag -o link.csv"),
        ("m.csv.json", "sim m.csv.json -o m.csv"),
        ("m.svg", "sim m.svg --plot m.svg"),
        ("m.h", "build m.h -o ."),
        ("m.json", "linearize m.json -o m.json"),
        ("m.svg", "linearize m.svg --plot m.svg"),
        ("M_default_modes.png", "linearize M_default_modes.png --plot"),
    ],
)
def test_the_model_is_not_written_over(
    file: str, command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "model M coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0}); end M;"
    (tmp_path / file).write_text(text)
    (tmp_path / "link.csv").symlink_to(file)
    monkeypatch.chdir(tmp_path)
    assert main(command.split()) == 2
    assert (tmp_path / file).read_text() == text


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("command", ["explain", "equations", "build", "sim", "linearize", "check"])
@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("zz=1", "LAG0601"),
        ("l=-3", "LAG0602"),
        ("l=1e309", "LAG0602"),
        ("l=3[kg]", "LAG0605"),
        ("n=3[m]", "LAG0605"),
    ],
)
def test_a_wrong_parameter_is_refused_by_every_command(
    command: str, given: str, code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "m.lag"
    path.write_text(
        "model M structural Integer n = 1; parameter Length l(min = 0) = 1; coordinate Real x[n];"
        " body b = Particle(mass = 1, at = {l*x[1], 0, 0}); end M;"
    )
    assert main([command, str(path), "-p", given]) == 2
    assert code in "".join(capsys.readouterr())


@pytest.mark.parametrize("start", ["theta=1_0", "nosuch=1", "theta=70"])
def test_of_two_things_that_are_wrong_the_same_is_told_whatever_the_cache_holds(
    start: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path))
    told = []
    words = ["sim", "simple_pendulum", "--backend", "numpy", "-q", "--stop", "0.1"]
    wrong = ["--step", "1e-2", "--rtol", "1e-6", "--start", start]
    for _ in range(2):
        assert main([*words, *wrong]) == 2
        told.append("".join(capsys.readouterr()))
        assert main(words) == 0
        capsys.readouterr()
    assert told[0] == told[1]
