"""`%load_ext lagc` in IPython."""

from typing import Any

import pytest

from tests.editor.texts import PENDULUM

shells = pytest.importorskip("IPython.core.interactiveshell")
pytestmark = pytest.mark.full


@pytest.fixture(scope="module")
def shell() -> Any:
    found = shells.InteractiveShell.instance()
    found.run_line_magic("load_ext", "lagc")
    return found


def cell(shell: Any, text: str) -> tuple[bool, list[dict[str, str]], str]:
    """Whether a cell succeeds, what it shows in each format, and what it prints."""
    from IPython.utils.capture import capture_output

    with capture_output() as captured:
        done = shell.run_cell(text, store_history=False)
    return done.success, [output.data for output in captured.outputs], captured.stderr


def test_a_cell_binds_a_model_and_shows_its_equations_and_motion(shell: Any) -> None:
    done, (equations, motion), _ = cell(shell, f"%%lag pendulum --scene lab --stop 1\n{PENDULUM}")
    assert done and r"\theta" in equations["text/latex"] and "<" in motion["text/html"]
    assert shell.user_ns["pendulum"].interface.scene == "lab"
    assert shell.user_ns["pendulum_run"].status == "ok"


def test_a_cell_changes_parameters(shell: Any) -> None:
    done, _, _ = cell(shell, f"%%lag pendulum -p l=70[cm] -p m=2\n{PENDULUM}")
    assert done and shell.user_ns["pendulum"].stepper()["l"] == 0.7
    done, outputs, printed = cell(shell, f"%%lag pendulum -p l\n{PENDULUM}")
    assert not done and not outputs and "`l` is not of the form name=value" in printed
    done, (shown,), _ = cell(shell, f"%%lag other -p q=3\n{PENDULUM}")
    assert "LAG0601" in shown["text/html"] and "`q`" in shown["text/html"]
    assert "other" not in shell.user_ns


def test_faults_are_shown_with_the_line_marked(shell: Any) -> None:
    done, (shown,), _ = cell(shell, "%%lag wrong\n" + PENDULUM.replace("sin(theta)", "sin(<b>)"))
    assert done and "wrong" not in shell.user_ns
    assert (
        "<b>error" in shown["text/html"]
        and "&lt;" in shown["text/html"]
        and "sin(<b>" not in shown["text/html"]
    )
    assert "LAG0" in shown["text/plain"]
    done, (shown,), _ = cell(shell, "%%lag wrong\n" + PENDULUM.replace("sin(theta)", "sin(thet)"))
    assert 'underline wavy #d33">thet</span>' in shown["text/html"] and "did you mean" in shown["text/html"]


def test_refused_is_shown_by_its_faults_and_options_are_explained(shell: Any) -> None:
    done, (shown,), _ = cell(shell, "import lagc; lagc.load('no_such_model')")
    assert not done and "<b>error" in shown["text/html"]
    done, outputs, printed = cell(shell, f"%%lag m --stop soon\n{PENDULUM}")
    assert not done and not outputs and "--stop" in printed
    done, outputs, printed = cell(shell, f"%%lag 2nd\n{PENDULUM}")
    assert not done and not outputs and "`2nd` is no name of Python" in printed
