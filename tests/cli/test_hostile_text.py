"""Text of models and of the command line never steers a terminal, nor breaks a line, a file or a format."""

import csv
import io
import json
import random
import unicodedata
from pathlib import Path
from xml.etree import ElementTree

import pytest

from lagc.base.text import json_text, one_line, printable
from lagc.cli.main import main
from lagc.diagnostics.faults import Fault, Source, Span, report

pytestmark = pytest.mark.usefixtures("own_cache")
Capture = pytest.CaptureFixture[str]
# C0, DEL, C1, marks and overrides of direction, ends of lines, a byte order mark, private use, half a letter
EVIL = [
    chr(c)
    for c in (*range(1, 9), *range(11, 32), *range(127, 160), *range(0x202A, 0x202F), *range(0x2066, 0x206A),
              0x061C, 0x200E, 0x200F, 0x2028, 0x2029, 0xFEFF, 0xE000, 0xE0041)
]  # fmt: skip
HOSTILE = [
    "\x1b[31mred", "\x1b]0;title\x07", "a\rb", "\x9b2J", "\u202egal.x", "=1+1", "<script>", '"', "\\", "%s{}",
]  # fmt: skip


def texts(count: int, seed: int = 1) -> list[str]:
    chance = random.Random(seed)
    return [
        chance.choice(EVIL) + "".join(chance.choice([*EVIL, *HOSTILE, "x", " "]) for _ in range(8))
        for _ in range(count)
    ]


def is_harmless(text: str) -> bool:
    return all(c.isprintable() or c == "\n" for c in text)


def test_every_character_that_is_not_printable_is_escaped_and_told_apart() -> None:
    for code in [*range(0x3000), *range(0xD800, 0xE010), *range(0xFE00, 0x10000), *range(0xE0000, 0xE0080)]:
        char = chr(code)
        shown = one_line(f"a{char}b")
        assert is_harmless(shown) and "\n" not in shown
        assert unicodedata.category(char)[0] in "CZ" or shown == f"a{char}b"
        assert (printable(char) == char) == (char.isprintable() or char == "\n")
        found = json_text({"a": f"{char}"})
        assert is_harmless(found) and json.loads(found)["a"] == char
        assert json_text({"a": char}, encoding="ascii").isascii()


@pytest.mark.full
def test_nothing_that_the_command_line_says_steers_the_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.chdir(tmp_path)
    for text in texts(40):
        name = text.replace("/", "").replace("\0", "")
        for words in (
            [name], ["sim", name], ["check", name], ["fmt", name], ["new", name],
            ["sim", "simple_pendulum", "-o", name],
            ["sim", "simple_pendulum", "--plot", f"{name}.xyz"],
            ["sim", "simple_pendulum", "-p", f"{name}=1"],
            ["sim", "simple_pendulum", "-p", f"l=1[{name}]"], ["sim", "simple_pendulum", "--scene", name],
            ["explain", "simple_pendulum", "--with", name], ["sim", "simple_pendulum", f"--stop={name}"],
            ["build", "simple_pendulum", f"--target={name}"], ["check", "--explain", name],
            ["sim", name, "--json"], ["check", name, "--format", "json"],
        ):  # fmt: skip
            assert main(words) in (1, 2), words
            out, err = capsys.readouterr()
            assert is_harmless(out) and is_harmless(err), words
            if "-o" in words:
                assert out + err  # faults of the expression, each with its line
            elif words[-1] not in ("--json", "json"):
                assert len((out + err).splitlines()) <= 3, words  # a fault, and its remedy
            else:
                json.loads(out)


def test_names_of_files_are_escaped_in_lists(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["build", "simple_pendulum", "-o", "\x1b[31m\nred"]) == 0
    shown = capsys.readouterr().out
    assert is_harmless(shown) and shown.count("\n") == 2 and "\\x1b[31m\\nred" in shown
    assert (tmp_path / "\x1b[31m\nred" / "simple_pendulum.c").is_file()


@pytest.mark.full
def test_nothing_in_a_model_steers_the_terminal_or_breaks_a_file(tmp_path: Path, capsys: Capture) -> None:
    pytest.importorskip("matplotlib")
    for number, text in enumerate(texts(12, seed=2)):
        quoted = text.replace("\\", "\\\\").replace('"', '\\"')
        folder = tmp_path / str(number)
        folder.mkdir()
        model = folder / f"m{text.replace('/', '')}.lag"
        model.write_text(
            f'model P "{quoted}"\n  parameter Length l = 1 [m] "{quoted}"; // {text}\n'
            f'  coordinate Angle theta(start = 1) "{quoted}";\n'
            "  body b = Particle(mass = 1 [kg], at = l*{sin(theta), 0, -cos(theta)});\n"
            f'  output Angle o = 2*theta "{quoted}";\nend P;\n',
            newline="",
        )
        at = str(model)
        for words in (
            ["check", at], ["explain", at, "-v"], ["explain", at, "--json"], ["equations", at],
            ["equations", at, "--format", "latex"], ["equations", at, "--format", "sympy"],
            ["sim", at, "-v", "--stop", "0.1", "-o", str(folder / "r.csv"), "--plot", str(folder / "r.svg")],
            ["linearize", at, "-v", "--plot", str(folder / "m.svg")],
            ["linearize", at, "--json", "--equilibrium"],
            ["sim", at, "--json", "--stop", "0.1"], ["build", at, "-o", str(folder), "--json"],
        ):  # fmt: skip
            code = main(words)
            out, err = capsys.readouterr()
            assert code in (0, 1), (words, err)
            assert is_harmless(out) and is_harmless(err), words
        if code == 0:
            rows = list(csv.reader(io.StringIO((folder / "r.csv").read_text())))
            assert rows[0] == ["time", "theta", "der(theta)", "o"] and {len(row) for row in rows} == {4}
            about = (folder / "r.csv.json").read_text()
            assert is_harmless(about) and model.name.endswith(json.loads(about)["source"])
            ElementTree.parse(folder / "r.svg")
            for name in ("p.c", "p.h"):
                assert is_harmless((folder / name).read_text()), name


def test_a_caret_stands_below_what_it_means() -> None:
    """By the columns of a terminal: wide characters take two, marks none, tabs reach the next stop."""
    chance = random.Random(3)
    for _ in range(300):
        before = "".join(
            chance.choice(["a", "\t", "\u754c", "e\u0301", "\x1b", "\u202e", " "]) for _ in range(9)
        )
        wanted = chance.choice(["x", "\u754c\u754c", "wrong"])
        source = Source("m.lag", f"{before}{wanted};\n")
        lines = report([Fault("LAG0201", "x", Span(source, len(before), len(before) + len(wanted)))]).split(
            "\n"
        )
        shown, marks = lines[-2], lines[-1]
        start = marks.index("^")
        assert cells(shown[: shown.rindex(wanted)]) == start
        assert marks.count("^") == cells(wanted) and is_harmless("".join(lines))


def cells(text: str) -> int:
    wide = sum(unicodedata.east_asian_width(c) in "WF" for c in text)
    return len(text) + wide - sum(unicodedata.combining(c) != 0 for c in text)
