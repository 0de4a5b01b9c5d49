"""The pages of the site from those of the repository: links that leave `docs/` lead to copies, code of models
has the name of the language, and a page of the Python interface is written from its docstrings."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

PROJECT = ("CHANGELOG", "CONTRIBUTING", "SECURITY", "LICENSE")  # files beside docs/ that have a page
WIDE = "---\nhide: [navigation]\n---\n\n"  # of a page without pages beside it
API = """# Python interface, by its docstrings

::: lagc
    options: {members: false, show_root_heading: false}

::: lagc.load

::: lagc.loads

::: lagc.ModelFile

::: lagc.CompiledModel
    options: {inherited_members: true}

::: lagc.api.run.Run
    options: {inherited_members: true}

::: lagc.Limits
    options: {members: false}

::: lagc.Refused
"""
_LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]*)(#[^)\s]*)?\)")
_FENCE = re.compile(r"^( *)```modelica$", re.MULTILINE)


def copy(root: Path, to: Path) -> None:
    """Write the pages of the checkout `root` into the folder `to`."""
    shutil.copytree(root / "docs", to)
    shutil.copy(root / "README.md", to / "index.md")
    for name in PROJECT:
        shutil.copy(next(root.glob(f"{name}*")), to / f"{name}.md")
    shutil.copytree(root / "models", to / "models")
    for path in [*to.rglob("*.md")]:
        text = path.read_text(encoding="utf-8")
        text = _FENCE.sub(r"\1```lag", _LINK.sub(lambda found, at=path: _link(found, at, to), text))
        path.write_text(WIDE * (path.stem in ("index", "tutorial")) + text, encoding="utf-8")
    (to / "reference" / "api.md").write_text(API, encoding="utf-8")


def _link(found: re.Match[str], page: Path, to: Path) -> str:
    """Return a link of a page with its target in the tree of the site."""
    target, anchor = found[1], found[2] or ""
    if target and not (page.parent / target).exists():
        name = Path(target).name.partition(".")[0]
        if name in (*PROJECT, "README"):
            place = to / ("index.md" if name == "README" else f"{name}.md")
        else:
            place = to / target.removeprefix("docs/").lstrip("./")
        target = "../" * len(page.relative_to(to).parent.parts) + place.relative_to(to).as_posix()
    return f"]({target}{anchor})"
