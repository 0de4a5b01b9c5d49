"""The generated C in several threads under the race detector of the compiler."""

import random
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

from lagc.codegen.c.emit import render
from lagc.codegen.identifiers import prefix
from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice
from lagc.host.model_library import read
from lagc.lowering.program import Program
from tests.simulation.programs import programs

CHECK = ["gcc", "-std=c99", "-g", "-O1", "-fsanitize=thread", "-pthread"]
MAIN = """
#include "{file}"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#define THREADS {threads}
#define STATES 3

static {name}_params p;
static {name}_options o;
static double x0[{NAME}_NX];
static {name}_work works[THREADS];
static double ends[THREADS][{NAME}_NX];

static void *move(void *given)
{{
    const int own = (int)(size_t)given;
    {name}_work *w = works + (SHARED ? 0 : own);
    {name}_state *s = ({name}_state *)malloc(STATES * sizeof *s);
    double x[{NAME}_NX], xdot[{NAME}_NX];
    int i, k;
    for (i = 0; i < STATES; i++)
        {name}_begin(s + i, 0.0, x0);
    for (k = 1; k <= 8; k++)
        for (i = 0; i < STATES; i++) {{
            if ({name}_advance(&p, s + i, 0.01 * k, &o, w) != {NAME}_OK)
                exit(3);
            {name}_dense(&p, s + i, 0.5 * (s[i].t + s[i].t_old), &o, x, w);
            {name}_rhs(&p, 0.0, x, xdot, NULL, w);
        }}
    for (i = 0; i < {NAME}_NX; i++)
        ends[own][i] = s[STATES - 1].x[i];
    free(s);
    return NULL;
}}

int main(void)
{{
    pthread_t threads[THREADS];
    int i, k;
    p = {name}_default_params();
    o = {name}_default_options();
    o.rtol = o.atol = 1e-6;
#ifdef {NAME}_NPREPARED
    {name}_bind(&p);
#endif
    {name}_start(&p, x0);
    for (i = 0; i < THREADS; i++)
        pthread_create(threads + i, NULL, move, (void *)(size_t)i);
    for (i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    for (i = 1; i < THREADS; i++)
        for (k = 0; k < {NAME}_NX; k++)
            if (ends[i][k] != ends[0][k])
                return 4;
    return 0;
}}
"""


@cache
def detector_works() -> bool:
    """Whether a program with the detector can be built, and runs on this kernel."""
    import tempfile

    if shutil.which("gcc") is None:
        return False
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.c").write_text("int main(void) { return 0; }\n")
        built = subprocess.run([*CHECK, "a.c", "-o", "a"], cwd=folder, capture_output=True)
        return built.returncode == 0 and subprocess.run([f"{folder}/a"], capture_output=True).returncode == 0


def ran(program: Program, folder: Path, threads: int, shared: bool) -> subprocess.CompletedProcess[str]:
    name, sources = prefix(program.interface.model), render(program)
    file = next(f for f in sources if f.endswith(".h"))
    text = MAIN.format(name=name, NAME=name.upper(), file=file, threads=threads)
    for path, body in {**sources, "main.c": text}.items():
        (folder / path).write_text(body)
    units = [f for f in sources if f.endswith(".c")]
    command = [*CHECK, f"-DSHARED={int(shared)}", *units, "main.c", "-lm", "-o", "main"]
    subprocess.run(command, cwd=folder, check=True)
    return subprocess.run(["./main"], cwd=folder, capture_output=True, text=True)


@pytest.mark.full
@pytest.mark.skipif(not detector_works(), reason="there is no race detector")
@pytest.mark.parametrize("name", ["double pendulum", "pendulum", "body", "four bars, flat", "rolling disc"])
def test_no_race(name: str, tmp_path: Path) -> None:
    """Each thread with its own workspace for several states; parameters and options are shared."""
    disc = Compilation(read("classic/rolling_disc"), Choice()).program
    program = disc if name == "rolling disc" else programs()[name]
    done = ran(program, tmp_path, random.Random(name).randint(2, 8), shared=False)
    assert done.returncode == 0, done.stderr[:2000]


@pytest.mark.full
@pytest.mark.skipif(not detector_works(), reason="there is no race detector")
def test_the_detector_sees_a_shared_workspace(tmp_path: Path) -> None:
    done = ran(programs()["pendulum"], tmp_path, 4, shared=True)
    assert done.returncode != 0 and "data race" in done.stderr
