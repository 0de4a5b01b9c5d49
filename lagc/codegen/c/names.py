"""The final form of the names in generated C.

The printers write `lagc_` and `LAGC_` before each name. In the header these become the prefix of the model.
In the source only public functions keep it: kernels, constants and types have the names that they have in
`lagc.kernels`, and a few lines at the top give such names to types, sizes and statuses of the header. Tables
end with `_table`, as locals of kernels may have their names.
"""

from __future__ import annotations

import re

PLACE = "/* names */\n"  # of these lines
_KEPT = "LAGC_ANY_ARITHMETIC"  # a macro of the user
_NAME = re.compile(r"\b(?:lagc|LAGC)_\w+")


def in_header(text: str, own: str) -> str:
    """Return the text of the header; `own`: the prefix of the model."""
    return re.sub(r"\bLAGC_", f"{own.upper()}_", re.sub(r"\blagc_", f"{own}_", text))


def in_source(text: str, header: str, own: str) -> str:
    """Return the text of the source; `header`: the header before its names got their form."""
    public, used = set(_NAME.findall(header)), set(_NAME.findall(text))
    taken = {in_header(name, own) for name in public}  # reset_conditions, of a model Reset
    types = {name: _type(name) for name in re.findall(r"\} (lagc_\w+);", header + text)}
    tables = {
        n: f"{n.removeprefix('lagc_')}_table"
        for n in re.findall(r"^static const \S+ (lagc_[a-z_]+)\[", text, re.M)
    }

    # Public functions have the prefix of the model; all other names are plain, unless that is taken.
    def form(match: re.Match[str]) -> str:
        name = match[0]
        if name == _KEPT or (name in public and name.startswith("lagc_") and name not in types):
            return in_header(name, own)
        plain = types.get(name) or tables.get(name) or name[len("lagc_") :]
        return f"{plain}_" if plain in taken else plain

    # Plain names of what the header declares: types, sizes, statuses and other numbers.
    named = [name for name in dict.fromkeys(_NAME.findall(header)) if name in used and name != _KEPT]
    lines = [f"typedef {in_header(name, own)} {types[name]};" for name in named if name in types]
    sizes = re.findall(r"#define (\w+) ", header)
    statuses = _NAME.findall("".join(re.findall(r"enum \{([^}]*)\} lagc_status;", header)))
    groups: dict[str, list[str]] = {"enum {": [], "static const Status": [], "static const int": []}
    kinds = {**dict.fromkeys(statuses, "static const Status"), **dict.fromkeys(sizes, "enum {")}
    for name in named:
        if name.startswith("LAGC_"):
            kind = kinds.get(name, "static const int")
            groups[kind].append(f"    {name.removeprefix('LAGC_')} = {in_header(name, own)}")
    for kind, rows in groups.items():
        if rows:
            lines += [kind, ",\n".join(rows) + ("\n};" if kind == "enum {" else ";")]
    return _NAME.sub(form, text).replace(PLACE, "\n".join(lines) + "\n")


def _type(name: str) -> str:
    """Return the name of a record as kernels have it: StartWork for lagc_start_work."""
    return "".join(word.capitalize() for word in name.split("_")[1:])
