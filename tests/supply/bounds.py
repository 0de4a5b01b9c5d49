"""What pyproject.toml demands, and the lock that follows from it."""

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).parents[2]
LOCK = ROOT / "requirements-dev.lock"
CHECKERS = {"mypy", "ruff"}  # each version of them finds something else: the newest counts


@cache
def project() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def requirements() -> list[Requirement]:
    """All of them: of the build, of lagc, of its extras; not the tools that lagc is compared with."""
    metadata = project()["project"]
    words = [*project()["build-system"]["requires"], *metadata["dependencies"]]
    extras = {name: found for name, found in metadata["optional-dependencies"].items() if name != "peers"}
    words += [word for extra in extras.values() for word in extra]
    return [found for found in map(Requirement, words) if found.name != metadata["name"]]


def bound(requirement: Requirement, sign: str) -> Version | None:
    """The version behind `>=` or `<`."""
    return next((Version(s.version) for s in requirement.specifier if s.operator == sign), None)


def lowest() -> list[str]:
    """`name==version` at every lower bound, but for the checkers: constraints for pip."""
    words = {f"{r.name}=={bound(r, '>=')}" for r in requirements() if r.name not in CHECKERS}
    return sorted(words)


def locked() -> dict[str, tuple[set[str], int]]:
    """Of the lock: name -> its versions (one for each Python), and how many hashes."""
    found: dict[str, tuple[set[str], int]] = {}
    for entry in re.split(r"\n(?=[a-z])", LOCK.read_text(encoding="utf-8")):
        head = re.match(r"([a-z][a-z0-9-]*)==(\S+)", entry)
        if head:
            versions, hashes = found.get(head[1], (set(), 0))
            found[head[1]] = (
                versions | {head[2]},
                hashes + len(re.findall(r"--hash=sha256:[0-9a-f]{64}\b", entry)),
            )
    return found
