"""The generated C in a program of one's own: a loop of steps with dense output, under sanitizers."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from lagc.codegen.c.emit import render
from lagc.codegen.identifiers import prefix
from lagc.simulation.system import OK, Options
from tests.simulation.programs import NAMES, built, programs

MAIN = """
#include "{name}.h"
#include <stdio.h>
#include <stdlib.h>

static void show(const double *x)
{{
    int i;
    for (i = 0; i < {NAME}_NX; i++)
        printf("%a ", x[i]);
}}

int main(void)
{{
    {name}_params p = {name}_default_params();
    {name}_options o = {name}_default_options();
    {name}_work *w = ({name}_work *)calloc(1, sizeof *w);
    {name}_state s;
    double x[{NAME}_NX];
    o.rtol = o.atol = 1e-6;
    {name}_bind(&p);
    {name}_start(&p, x);
    {name}_begin(&s, 0.0, x);
    while (s.t < 1.0) {{
        if ({name}_step(&p, &s, 1.0, &o, w) != {NAME}_OK)
            return 1;
        if ({name}_dense(&p, &s, s.t_old + 0.3 * (s.t - s.t_old), &o, x, w) != {NAME}_OK)
            return 2;
        show(x);
    }}
    if ({name}_advance(&p, &s, 1.5, &o, w) != {NAME}_OK || s.t != 1.5)
        return 3;
    show(s.x);
    free(w);
    return 0;
}}
"""


@pytest.mark.sample(0, 3)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("model", NAMES)
def test_a_loop_of_steps(model: str, tmp_path: Path) -> None:
    """The same bits as the loop in Python; no access out of bounds, no undefined operation."""
    program = programs()[model]
    name = prefix(program.interface.model)
    sources = {**render(program), "main.c": MAIN.format(name=name, NAME=name.upper())}
    for file, text in sources.items():
        (tmp_path / file).write_text(text)
    units = [file for file in sources if file.endswith(".c")]
    command = ["gcc", "-std=c99", "-g", "-O0", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    for extra in (checks, []):
        done = subprocess.run(
            [*command, *extra, *units, "-lm", "-o", "main"], cwd=tmp_path, capture_output=True
        )
        if done.returncode == 0:
            break
    assert done.returncode == 0, done.stderr.decode()
    ran = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    found = [float.fromhex(word) for word in ran.stdout.split()]

    system: Any = built(model, "numpy")
    expected: list[float] = []
    options, integrator = Options(rtol=1e-6, atol=1e-6), system.model.module["Integrator"]
    run = integrator(system.equations(), options, 0.0, system.start())
    while run.t < 1.0:
        assert run.step(1.0) == OK
        status, x = run.at(run.t_old + 0.3 * (run.t - run.t_old))
        assert status == OK
        expected += x
    while run.t != 1.5:
        assert run.step(1.5) == OK
    assert found == [*expected, *run.x]
