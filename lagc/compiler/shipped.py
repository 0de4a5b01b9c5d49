"""The files that an installation brings: the parser's tables, and the kernels of common models."""

from itertools import product
from pathlib import Path

from lagc.base.records import replace
from lagc.codegen.kernel_compiler import library
from lagc.codegen.python import initialization
from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice, render
from lagc.diagnostics.faults import Source
from lagc.host import cache
from lagc.kernels import DEFAULT_METHOD
from lagc.syntax import lalr_tables

# Without and with constraints, quaternions, events, clauses, contacts, in the plane and in space.
COMMON = (
    "course/simple_pendulum", "classic/double_pendulum", "classic/four_bar", "classic/rolling_disc",
    "classic/heavy_top_quaternion", "classic/on_off_drive", "classic/sampled_pd", "contact/bouncing_ball",
    "contact/block_on_belt", "contact/billiard",
)  # fmt: skip
LANGUAGES = ("python", "double")


def files(root: Path) -> dict[Path, str]:
    """Return the texts by path; `root`: a checkout."""
    with cache.unused():
        for name in COMMON:
            path = root / "models" / f"{name}.lag"
            program = Compilation(Source(path.name, path.read_text(encoding="utf-8")), Choice()).program
            run = replace(program, interface=replace(program.interface, methods=(DEFAULT_METHOD,)))
            for target in ("c", "numpy"):
                render(run, target, complete=False)
            render(program, "c")
        for kinds in product((False, True), repeat=len(initialization.FLAGS)):
            initialization.text(dict(zip(initialization.FLAGS, kinds)))
        made = {library.shipped_path(language): library.packed(language) for language in LANGUAGES}
        made[lalr_tables.shipped_path()] = lalr_tables.packed()
    return {Path(path): text for path, text in made.items()}
