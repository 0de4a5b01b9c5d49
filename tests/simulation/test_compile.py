"""What a C compiler leaves behind is looked at before it is loaded."""

import random
import subprocess
import sys
from pathlib import Path

import pytest

from lagc.simulation.backends import compile as compile_
from lagc.simulation.backends.compile import CannotCompile, build_library, compiler

LOAD = """
import ctypes, sys
for path in sys.argv[1:]:
    try:
        ctypes.CDLL(path)
    except OSError:
        pass
"""


@pytest.mark.skipif(compiler() is None, reason="no C compiler")
@pytest.mark.skipif(sys.platform != "linux", reason="other systems look themselves")
def test_a_library_that_is_cut_off_kills_nobody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = build_library(
        {"n.c": "#include <math.h>\ndouble n[999] = {1};\ndouble f(double x) { return sin(x); }"}
    )
    chance, accepted = random.Random(1), list[str]()
    lengths = [0, 1, 63, 64, len(whole), *(chance.randrange(len(whole)) for _ in range(60))]
    for length in lengths:
        path = tmp_path / f"{length}.so"
        path.write_bytes(whole[:length])
        monkeypatch.setattr(compile_, "_compile", lambda *_, path=path: str(path))
        try:
            build_library({})
            accepted.append(str(path))
        except CannotCompile:
            pass
    assert str(tmp_path / f"{len(whole)}.so") in accepted and len(accepted) < len(lengths) / 2
    assert subprocess.run([sys.executable, "-c", LOAD, *accepted], check=False).returncode == 0
