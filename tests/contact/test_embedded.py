"""The program of how-to/embed-the-c.md that reads events of contacts, against the closed form."""

import re
import shutil
import subprocess
from math import sqrt
from pathlib import Path

import pytest

from lagc.cli.main import main

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "embed-the-c.md"
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.usefixtures("own_cache")
def test_the_program_that_reads_events(tmp_path: Path) -> None:
    """A ball of 1 kg from 1 m: all flights end at 3 t1 with e = 1/2; its impulses add up to (1 + e)/(1 - e)
    times that of stopping it once, m g t1 (W. Goldsmith, Impact, 1960, 1.2)."""
    (program,) = re.findall(r"```c\n(#include \"bouncing_ball.h\".*?)```", PAGE.read_text("utf-8"), re.S)
    assert main(["build", "bouncing_ball", "--target", "c", "-o", str(tmp_path), "-q"]) == 0
    (tmp_path / "main.c").write_text(program)
    command = ["gcc", *STRICT, "main.c", "bouncing_ball.c", "-lm", "-o", "main"]
    subprocess.run(command, cwd=tmp_path, check=True)
    done = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=True)
    rest, impacts, impulse, height = re.findall(r"[-\d.]+(?:e-\d+)?(?= s\n| impacts| N s| m)", done.stdout)
    fall = sqrt(2 / 9.81)
    assert float(rest) == pytest.approx(3 * fall, rel=1e-8)  # the printed digits; rtol is 1e-9
    left = 3 * sqrt(2 * 9.81 * 1e-10)  # of bounces that are not followed: lower than 1e-10 of 1 m
    assert 0.0 < 3 * 9.81 * fall - float(impulse) <= left
    assert int(impacts) > 10 and float(height) == 0.0
