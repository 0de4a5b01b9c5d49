"""Build the site: the documentation, a page for each model of the library, and the playground.

    python -m tools.site FOLDER [--models NAME ...] [--with zensical | mkdocs] [--no-playground]

Needs `pip install -e '.[docs]'`, and Node for the playground. Ends with 1 if the builder warns.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tools.playground import __main__ as playground
from tools.site import gallery, tree

ROOT = Path(__file__).resolve().parent.parent.parent
HERE = ROOT / "tools" / "site"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tools.site", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--with", dest="builder", choices=("zensical", "mkdocs"), default="zensical")
    parser.add_argument("--models", nargs="*", default=(), help="for a gallery of these alone")
    parser.add_argument("--no-playground", action="store_true")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        source = Path(work)
        tree.copy(ROOT, source / "docs")
        gallery.write(source / "docs", asked.models)
        shutil.copy(HERE / "mkdocs.yml", source)
        shutil.copy(HERE / "site.css", source / "docs")
        (source / "lib").symlink_to(ROOT)
        made = subprocess.run([sys.executable, "-m", asked.builder, "build"], cwd=source, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)  # fmt: skip
        sys.stdout.write(made.stdout)
        if made.returncode or "warning" in made.stdout.lower():
            return 1
        shutil.copytree(source / "site", asked.folder, dirs_exist_ok=True)
    if not asked.no_playground:
        playground.build(asked.folder / "playground")
    return 0


if __name__ == "__main__":
    sys.exit(main())
