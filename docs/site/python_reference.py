# SPDX-License-Identifier: MIT
"""Print the Python reference, a page of the site, from the texts of the installed package."""

import ast
import enum
import inspect
from collections.abc import Iterator
from typing import Any

import roburoc4
import roburoc4.gate
import roburoc4.iocard
import roburoc4.latest
import roburoc4.notices
import roburoc4.offline
import roburoc4.records
import roburoc4.robot_file
import roburoc4.samples
from roburoc4_tools import recordings

HEAD = """\
# Python reference

Every name of the package `roburoc4`; [python.md](python.md) shows how they are used. What is on the
wire is in `roburoc4.protocol`; the types of what attributes return, in `roburoc4.records` and
`roburoc4.iocard`; what bridges and tools use, in `roburoc4.gate`, `latest`, `notices`, `offline`,
`robot_file` and `samples`; what reads recordings, in `roburoc4_tools.recordings`: their names are
shown with the module. In `roburoc4.aio` methods of the same names are awaited.
"""


PARTS = (
    roburoc4.protocol,
    roburoc4.records,
    roburoc4.iocard,
    roburoc4.gate,
    roburoc4.latest,
    roburoc4.notices,
    roburoc4.offline,
    roburoc4.robot_file,
    roburoc4.samples,
)


def labels() -> dict[Any, str]:
    """Return every public thing with its name, which begins with its module: "protocol.decode"."""
    found: dict[Any, str] = {}
    for module in (roburoc4, *PARTS, recordings):
        prefix = module.__name__.partition(".")[2]
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isclass(thing) or inspect.isfunction(thing):
                found.setdefault(thing, f"{prefix}.{name}" if prefix else name)
    return found


def attribute_texts(owner: type) -> dict[str, str]:
    """Return the texts below the attributes of a class."""
    (tree,) = ast.parse(inspect.getsource(owner)).body
    assert isinstance(tree, ast.ClassDef)
    found: dict[str, str] = {}
    name = ""
    for line in tree.body:
        if isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name):
            name = line.targets[0].id
        elif isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name):
            name = line.target.id
        elif isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and name:
            found[name] = plain(str(line.value.value))
            name = ""
    return found


def plain(text: str | None, *, first: bool = True) -> str:
    """Return a docstring, or its first paragraph, in one line of Markdown."""
    text = inspect.cleandoc(text or "")
    if first:
        text = text.partition("\n\n")[0]
    for old, new in ((":class:", ""), (":meth:", ""), (":func:", ""), ("``", "`"), ("|", "\\|")):
        text = text.replace(old, new)
    return " ".join(text.split())


def table(*rows: tuple[str, ...]) -> Iterator[str]:
    """Write rows, the first of which is the head."""
    yield "| " + " | ".join(rows[0]) + " |"
    yield "| " + " | ".join("---" for _ in rows[0]) + " |"
    for row in rows[1:]:
        yield "| " + " | ".join(row) + " |"
    yield ""


def signature(function: object) -> str:
    """Return the names of a function's arguments, with their defaults."""
    parameters = inspect.signature(function).parameters.values()  # type: ignore[arg-type]
    shown = [p.replace(annotation=p.empty) for p in parameters if p.name not in ("self", "_cls")]
    return str(inspect.Signature(shown))


def members(owner: type) -> Iterator[tuple[str, str]]:
    """Return the public methods and properties of a class, and what they do."""
    for name in sorted({n for kind in owner.__mro__[:-1] for n in vars(kind)}):
        value = inspect.getattr_static(owner, name)
        if name.startswith("_") or not (isinstance(value, property) or inspect.isfunction(value)):
            continue
        shown = name if isinstance(value, property) else name + signature(value)
        yield f"`{shown}`", plain(inspect.getdoc(getattr(owner, name)), first=False)


def enumeration(owner: type[enum.IntEnum] | type[enum.IntFlag]) -> Iterator[str]:
    """Write the members of an enumeration."""
    texts = attribute_texts(owner)
    yield f"### {labels()[owner]}\n\n{plain(owner.__doc__)}\n"
    rows = []
    for member in owner:
        number = f"{member.value:#x}" if issubclass(owner, enum.IntFlag) else str(member.value)
        rows.append((f"`{member.name}`", number, texts.get(member.name or "") or member.text))  # type: ignore[union-attr]
    yield from table(("member", "number", "meaning"), *rows)


def settings(owner: type) -> Iterator[str]:
    """Write the keys of settings."""
    texts = attribute_texts(owner)
    rows = [(f"`{name}`", texts[name]) for name in owner.__annotations__]
    yield from table(("setting", "meaning; range; default"), *rows)


def record(owner: type) -> Iterator[str]:
    """Write the fields of a record."""
    texts = attribute_texts(owner)
    yield f"### {labels()[owner]}\n\n{plain(owner.__doc__)}\n"
    fields = owner._fields  # type: ignore[attr-defined]
    yield from (
        f"- `{name}`{': ' if name in texts else ''}{texts.get(name, '')}" for name in fields
    )
    yield ""


def page() -> str:
    """Return the whole page."""
    public = sorted(labels(), key=lambda thing: str(labels()[thing]))
    classes = [value for value in public if inspect.isclass(value)]
    enumerations = [c for c in classes if issubclass(c, enum.IntEnum | enum.IntFlag)]
    records = [c for c in classes if issubclass(c, tuple) and hasattr(c, "_fields")]
    errors = [c for c in classes if issubclass(c, Exception)]
    typed = [roburoc4.Settings, roburoc4.SimSettings]
    others = [c for c in classes if c not in (*enumerations, *records, *errors, *typed)]
    lines = [HEAD, "## Functions\n"]
    lines += table(
        ("function", "what it does"),
        *(
            (f"`{labels()[f]}{signature(f)}`", plain(f.__doc__))
            for f in public
            if inspect.isfunction(f)
        ),
    )
    lines += ["## Settings of `connect`\n", *settings(roburoc4.Settings)]
    lines += ["## Events and other enumerations\n"]
    lines += [line for owner in enumerations for line in enumeration(owner)]
    lines += ["## Classes\n"]
    for owner in others:
        lines += [f"### {labels()[owner]}\n\n{plain(owner.__doc__)}\n"]
        rows = list(members(owner))
        lines += table(("member", "what it does"), *rows) if rows else []
    lines += ["## Records\n", *(line for owner in records for line in record(owner))]
    lines += ["## Exceptions\n"]
    lines += table(("exception", "when"), *((f"`{labels()[c]}`", plain(c.__doc__)) for c in errors))
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    print(page(), end="")
