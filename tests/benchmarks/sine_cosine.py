"""A pair of sine and cosine: ours beside the C library's, in C and in Python.

    python -m tests.benchmarks sine_cosine

Independent: each angle is known before; chained: each is made of the pair before.  Least CPU times, in ns.
"""

from __future__ import annotations

import math
import random
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from lagc.codegen.c import runtime
from lagc.codegen.python import functions
from lagc.codegen.trigonometry import sine_cosine_kernels
from lagc.simulation.backends.compile import FLAGS, compiler

RANGES = (0.7, 3.1, 100.0)
DRIVER = r"""
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#define N 256
static double angle[N], out[2 * N + 2];
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static void library(double x, double *pair) { pair[0] = sin(x); pair[1] = cos(x); }
#define CALLS(name, function) \
    static void name(void) { for (int i = 0; i < N; i++) function(angle[i], out + 2 * i); } \
    static void name##_chained(void) \
    { \
        for (int i = 0; i < N; i++) \
            function(angle[i] + 1e-30 * (out[2 * i] + out[2 * i + 1]), out + 2 * i + 2); \
    }
CALLS(ours, lagc_sine_cosine)
CALLS(theirs, library)
static double least(void (*batch)(void))
{
    double best = 1.0;
    for (int k = 0; k < 5000; k++) {
        const double began = now();
        batch();
        batch();
        batch();
        batch();
        const double t = now() - began;
        best = t < best ? t : best;
    }
    return best / (4 * N) * 1e9;
}
int main(int argc, char **argv)
{
    for (int k = 1; k < argc; k++) {
        for (int i = 0; i < N; i++)
            angle[i] = atof(argv[k]) * (2.0 * rand() / RAND_MAX - 1.0);
        printf("%.2f %.2f ", least(ours), least(theirs));
        printf("%.2f %.2f\n", least(ours_chained), least(theirs_chained));
    }
    return 0;
}
"""


def in_c(kernel: str) -> list[list[float]]:
    with tempfile.TemporaryDirectory() as name:
        source, binary = Path(name, "a.c"), Path(name, "a")
        head = "#define _POSIX_C_SOURCE 199309L\n#include <math.h>\n"
        source.write_text(head + kernel.replace("lagc_real", "double") + DRIVER)
        words = compiler()
        assert words is not None, "no compiler"
        flags = [flag for flag in FLAGS if flag not in ("-fPIC", "-shared")]
        subprocess.run([*words, *flags, source, "-o", binary, "-lm"], check=True)
        text = subprocess.run([binary, *map(str, RANGES)], check=True, capture_output=True, text=True).stdout
    return [[float(word) for word in line.split()] for line in text.splitlines()]


def in_python(function: Callable[[float], tuple[float, float]], angles: Sequence[float]) -> float:
    best = math.inf
    for _ in range(100):
        began = time.process_time()
        for x in angles:
            function(x)
        best = min(best, time.process_time() - began)
    return best / len(angles) * 1e9


def main() -> None:
    kernels = sine_cosine_kernels(["sine_cosine(x)"])
    space: dict[str, Any] = {}
    exec("\n\n".join([functions.ARITHMETIC, *functions.sine_cosine(kernels)]), space)
    print("| angles up to | C: ours | library | chained: ours | library | Python: ours | library |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for largest, found in zip(RANGES, in_c("\n".join(runtime.sine_cosine(kernels)))):
        angles = [random.Random(k).uniform(-largest, largest) for k in range(1000)]
        found.append(in_python(space["sine_cosine"], angles))
        found.append(in_python(lambda x: (math.sin(x), math.cos(x)), angles))
        print(f"| {largest} | " + " | ".join(f"{value:.1f}" for value in found) + " |")


if __name__ == "__main__":
    main()
