"""Show, verify or clear the cache of compiled models.

It may be cleared at any time: lagc compiles again what is missing.
"""

import argparse
from typing import Any

from lagc.base.text import one_line
from lagc.cli.output import DONE, REFUSED, print_json, show
from lagc.host import cache
from lagc.host.cache import upkeep


def add_options(parser: argparse.ArgumentParser) -> None:
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--verify", action="store_true", help="read every entry and remove damaged ones (exit code 1)"
    )
    what.add_argument("--clear", action="store_true", help="remove every entry")


def run(options: argparse.Namespace) -> int:
    facts = facts_of(options)
    if options.json:
        print_json(facts)
    else:
        show("".join(line + "\n" for line in text(facts, options.quiet)))
    return DONE if facts["status"] == "ok" else REFUSED


def facts_of(options: argparse.Namespace) -> dict[str, Any]:
    """Do what the options ask, and return the state of the cache as plain data."""
    place = cache.opened()
    facts: dict[str, Any] = {"status": "ok", "folder": cache.folder()}
    if place is None:
        if cache.notes and facts["folder"] is not None:
            facts.update(status="refused", reason=cache.notes[-1])
        return facts
    try:
        with place:
            return facts | _maintain(place, options)
    except OSError as error:
        return facts | {"status": "refused", "reason": f"{place.path} cannot be read: {cache.reason(error)}"}


def _maintain(place: cache.Folder, options: argparse.Namespace) -> dict[str, Any]:
    facts: dict[str, Any] = {}
    if options.clear:
        facts["removed"] = upkeep.clear(place)
    if options.verify:
        found = upkeep.damaged(place)
        left = {entry.name for entry in upkeep.entries(place)}
        facts["damaged"] = [{"entry": n, "reason": reason, "removed": n not in left} for n, reason in found]
        facts["status"] = "damaged" if found else "ok"
    kinds: dict[str, list[int]] = {}
    for entry in upkeep.entries(place):
        kinds.setdefault(entry.kind, []).append(entry.size)
    facts["kinds"] = {kind: {"entries": len(s), "bytes": sum(s)} for kind, s in sorted(kinds.items())}
    facts["unfinished"] = len(upkeep.unfinished(place))
    facts["limit"] = upkeep.limit()
    return facts


def text(facts: dict[str, Any], quiet: bool) -> list[str]:
    """Return the lines that are printed."""
    if facts["status"] == "refused":
        return [str(facts["reason"])]
    if facts["folder"] is None:
        return ["there is no cache: LAGC_CACHE is empty, or the user has no home folder"]
    kinds = facts.get("kinds", {})
    lines = [
        f"{row['entry']} {'removed' if row['removed'] else 'cannot be removed'}: {row['reason']}"
        for row in facts.get("damaged", ())
    ]
    if not quiet:
        number, total = (sum(row[what] for row in kinds.values()) for what in ("entries", "bytes"))
        most = f", at most {size(facts['limit'])}" if "limit" in facts else ""
        lines.append(f"{one_line(facts['folder'])}: {number} entries, {size(total)}{most}")
        lines += [f"  {kind:9} {row['entries']:6} {size(row['bytes']):>9}" for kind, row in kinds.items()]
        if facts.get("unfinished"):
            lines.append(f"  {'unfinished':9} {facts['unfinished']:5}")
        if "removed" in facts:
            lines.append(f"{facts['removed']} removed")
        if facts.get("damaged") == []:
            lines.append("all entries are valid")
    return lines


def size(count: float) -> str:
    """Return a number of bytes as text in B, kB, MB or GB."""
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} GB"
