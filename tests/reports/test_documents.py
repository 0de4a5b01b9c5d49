"""What the documents show: models are models, commands and programs run as they are printed.

`tests/simulation/test_controller.py` compares the programs of how-to/embed-the-c.md with their results.
"""

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source

pytestmark = pytest.mark.usefixtures("own_cache")

ROOT = Path(__file__).parents[2]
DOCUMENTS = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]
EMBEDDED = "docs/how-to/embed-the-c.md"

SAVED = {  # under the names that the text around gives them
    "pendulum.lag": ("README.md", "SimplePendulum"),
    "swing.lag": ("docs/tutorial.md", "Swing"),
    "arm.lag": ("docs/tutorial.md", "Arm"),
    "thrown.lag": ("docs/tutorial.md", "Thrown"),
    "cart_pole.lag": (EMBEDDED, "CartPole"),
    "ladder.lag": ("docs/how-to/initial-conditions.md", "Ladder"),
    "servo.lag": ("docs/how-to/inputs-and-tables.md", "Servo"),
    "bounce.lag": ("docs/how-to/events.md", "Bounce"),
    "hoist.lag": ("docs/how-to/contacts.md", "Hoist"),
    "drive.lag": ("docs/how-to/discrete-variables.md", "OnOffDrive"),
    "sampled.lag": ("docs/how-to/discrete-variables.md", "SampledPd"),
}


def page(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def blocks(language: str) -> list[tuple[str, str]]:
    """(where, text) of every block of a language that is not marked as a fragment."""
    found = []
    for path in DOCUMENTS:
        text = path.read_text(encoding="utf-8")
        for match in re.finditer(
            rf"(?<!^<!-- fragment -->\n)^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL
        ):
            found.append((f"{page(path)}:{text.count(chr(10), 0, match.start()) + 2}", match[1]))
    return found


def lines() -> list[tuple[str, str]]:
    """(document, line) of every command of lagc, without those that install it."""
    return [
        (where.partition(":")[0], line)
        for where, text in blocks("sh")
        for line in text.splitlines()
        if line.startswith("lagc ")
    ]


@pytest.fixture
def saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the models of the documents, in which we are."""
    for name, (document, model) in SAVED.items():
        (text,) = [
            text
            for where, text in blocks("modelica")
            if where.startswith(f"{document}:") and text.startswith(f"model {model} ")
        ]
        (tmp_path / name).write_text(text, encoding="utf-8")
    inputs = (ROOT / "docs/how-to/inputs-and-tables.md").read_text(encoding="utf-8")
    data = re.findall(r"^    (time \[ms\].*|[-.\d]+,[-.\d]+)$", inputs, re.MULTILINE)
    (tmp_path / "drive.csv").write_text("\n".join(data) + "\n", encoding="utf-8")
    ((_, robot),) = blocks("xml")
    (tmp_path / "robot.urdf").write_text(robot, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


PAGES = sorted(
    {document for document, _ in lines()}, key=lambda page: ([x for x, _ in lines()].count(page), page)
)


def test_commands_are_shown_where_they_belong() -> None:
    assert {"README.md", "docs/tutorial.md", EMBEDDED} <= set(PAGES)


@pytest.mark.sample(1)
@pytest.mark.parametrize("document", PAGES)
def test_commands_run_as_printed_there(saved: Path, document: str) -> None:
    for shown, line in lines():
        if shown == document:
            assert main([*shlex.split(line, comments=True)[1:], "--no-color"]) == 0, line


COMMANDS = ["check", "fmt", "explain", "equations", "sim", "cost", "compare", "effects", "hard", "linearize"]
COMMANDS += ["build", "derive", "import", "new", "lsp", "cache", "sweep", "fit"]


@pytest.mark.parametrize("command", COMMANDS)
def test_options_are_those_of_the_commands(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Every option of `--help` is described, and a command has each option that its section describes."""
    text = (ROOT / "docs" / "reference" / "commands.md").read_text(encoding="utf-8")
    common = text[text.index("## Common options") : text.index("## `lagc check`")]
    own = text[text.index(f"## `lagc {command}`") :].split("\n## ")[0]
    assert main([command, "--help"]) == 0
    options = capsys.readouterr().out.partition("options:")[2]
    there = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", options)) - {"-h", "--help"}
    long = {"--parameter": "-p", "--output": "-o", "--quiet": "-q", "--verbose": "-v"}
    told = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", common + own))
    assert {long.get(option, option) for option in there} <= told
    described = set(re.findall(r"--[a-z][a-z-]*", "".join(re.findall(r"^\| `-.*?\|", own, re.MULTILINE))))
    assert described <= there


PROGRAMS = [b for b in blocks("python") if not b[0].startswith(EMBEDDED)]


@pytest.mark.full
@pytest.mark.parametrize(("where", "text"), PROGRAMS, ids=[where for where, _ in PROGRAMS])
def test_python_runs_as_printed_there(saved: Path, where: str, text: str) -> None:
    exec(compile(text, where, "exec"), {})


def test_the_model_of_the_robot_is_the_one_that_is_imported(
    saved: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (ROOT / "docs/how-to/import-a-robot.md").read_text(encoding="utf-8")
    assert main(["import", "robot.urdf"]) == 0
    assert f"```modelica\n{capsys.readouterr().out}```" in text


@pytest.mark.full
def test_what_is_found_for_a_start_is_what_is_said_there() -> None:
    text = (ROOT / "docs" / "reference" / "language.md").read_text(encoding="utf-8")
    (model,) = [text for where, text in blocks("modelica") if text.startswith("model Disc ")]
    road, straight = (
        lagc.loads(model).compile(scene, backend="numpy").simulate(0.01) for scene in ("road", "straight")
    )
    assert any(note in text for note in road.notes if note.startswith("found for the start")), road.notes
    assert straight["der(x)"][0] == pytest.approx(1.5, rel=1e-12)
    assert straight["der(psi)"][0] == straight["der(theta)"][0] == 0.0


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_c_of_the_interface_compiles_as_printed_there(saved: Path) -> None:
    """Its `#include` is the first line, what follows stands within a function."""
    ((_, text),) = [b for b in blocks("c") if b[0].startswith("docs/reference/c-interface.md:")]
    include, _, body = text.partition("\n")
    assert main(["build", "pendulum.lag", "--target", "c", "-o", ".", "-q"]) == 0
    program = f"{include}\nint main(void)\n{{\n{body}return xdot[0] != xdot[0];\n}}\n"
    (saved / "main.c").write_text(program)
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(["gcc", *strict, "main.c", "simple_pendulum.c", "-lm", "-o", "main"], check=True)
    subprocess.run(["./main"], check=True)


@pytest.mark.sample(5)
@pytest.mark.parametrize(("where", "text"), blocks("modelica"), ids=lambda x: x if len(x) < 40 else "")
def test_models_of_the_documents_are_accepted(where: str, text: str) -> None:
    assert check(Source(where, text), Choice()) == []


def prose(path: Path) -> str:
    return re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def anchors(path: Path) -> set[str]:
    """The names by which links reach the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", prose(path), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("path", DOCUMENTS, ids=page)
def test_links_lead_somewhere(path: Path) -> None:
    for link in re.findall(r"\]\(([^)]+)\)", prose(path)):
        if "://" not in link:
            target, _, anchor = link.partition("#")
            found = path.parent / target if target else path
            assert found.exists(), link
            assert not anchor or anchor in anchors(found), link
