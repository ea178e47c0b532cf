# SPDX-License-Identifier: MIT
"""read_as_matlab.py FOLDER: each .m file is MATLAB to the grammar of tree-sitter, and calls only
what MATLAB R2021a has: a function of MathWorks' reference list of R2020b, which Pygments has, or
one that documented/r2021a.txt names, or of functions.txt. (mh_lint reads the files with another
grammar.)
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import tree_sitter
import tree_sitter_matlab
from pygments.lexers.matlab import MatlabLexer
from pygments.token import Name

HERE = Path(__file__).parent
PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_matlab.language()))
# Their identifiers are names of properties, arguments and attributes.
SKIPPED = {"comment", "attributes", "metaclass_operator"}
# What they contain directly are variables.
BINDING = {
    "function_arguments",
    "function_output",
    "multioutput_variable",
    "iterator",
    "catch_clause",
}


def listed(name: str) -> dict[str, str]:
    """The names of a list, and what follows them."""
    lines = (HERE / name).read_text(encoding="ascii").splitlines()
    pairs = [line.partition(" ") for line in lines if line and not line.startswith("#")]
    return {name: note for name, _, note in pairs}


def reference_list() -> set[str]:
    """Those of Pygments' rules for functions."""
    rules = [rule for rule in MatlabLexer.tokens["root"] if isinstance(rule, tuple)]
    return {w for rule in rules if rule[1] is Name.Builtin for w in getattr(rule[0], "words", ())}


def text(node: tree_sitter.Node) -> str:
    return (node.text or b"").decode()


def below(node: tree_sitter.Node) -> Iterator[tree_sitter.Node]:
    yield node
    for child in node.children:
        if child.type not in SKIPPED:
            yield from below(child)


def variables(function: tree_sitter.Node) -> set[str]:
    found = set()
    for node in below(function):
        if node.type == "assignment":
            left = node.child_by_field_name("left")
            while left is not None and left.type in ("field_expression", "function_call"):
                left = left.child_by_field_name("object") or left.child_by_field_name("name")
            found |= {text(left)} if left is not None and left.type == "identifier" else set()
            if left is not None and left.type == "multioutput_variable":
                found |= {text(n) for n in below(left) if n.type == "identifier"}
        elif node.type in BINDING or (
            node.type == "arguments" and node.parent and node.parent.type == "lambda"
        ):
            found |= {text(child) for child in node.children if child.type == "identifier"}
    return found


def used(root: tree_sitter.Node) -> Iterator[tuple[int, str]]:
    """The names that are called, with their lines; of a dotted name all of it."""
    scopes = [n for n in below(root) if n.type == "function_definition"]
    inside = {n.id for scope in scopes for n in below(scope)}
    for scope in [root, *scopes]:
        known = variables(scope)
        for node in below(scope):
            if scope is root and scopes and node.id in inside:
                continue
            yield from names_of(node, known)


def names_of(node: tree_sitter.Node, known: set[str]) -> Iterator[tuple[int, str]]:
    parent = node.parent
    line = node.start_point[0] + 1
    if node.type == "superclasses":
        yield from ((line, text(n)) for n in node.children if n.type == "property_name")
    if node.type == "command_name":
        yield line, text(node)
    if node.type != "identifier" or parent is None or text(node) in known:
        return
    if parent.type in {
        "function_definition",
        "class_definition",
        "property",
        "property_name",
        *BINDING,
    }:
        return
    outer = parent
    first = node
    if parent.type == "function_call" and parent.child_by_field_name("name") == node:
        first, outer = parent, parent.parent or parent
    if outer.type == "field_expression":
        if outer.child_by_field_name("object") == first:
            yield line, text(outer).split("(")[0].strip()
        return  # else a field or a method
    yield line, text(node)


def faults(name: str, source: bytes, known: set[str], own: set[str]) -> Iterator[str]:
    """KNOWN are functions of MATLAB and Octave, OWN those of this project."""
    root = PARSER.parse(source).root_node
    if root.has_error:
        wrong = next(n for n in below(root) if n.is_error or n.is_missing)
        yield f"{name}:{wrong.start_point[0] + 1}: not MATLAB: {text(wrong)[:60]!r}"
    for line, called in used(root):
        if called not in known and called.split(".")[0] not in own:
            yield f"{name}:{line}: does R2021a have {called}? Name it in documented/r2021a.txt"


def check_itself(known: set[str]) -> None:
    """What is wrong is found, and nothing else."""
    for code, count in {
        "x = sin(1); y.z = x; y.z(2) = max([x, pi]); clear x": 0,
        "f = @(a) a + sqrt(4); [~, k] = min(f(1)); k(2) = f(k)": 0,
        "x = (1;": 1,
        "x = no_such(1)": 1,
        "x = cellfun(@no_such, {})": 1,
        "no_such x": 1,
        "x = matlab.no.such(1)": 1,
        "function f(a)\na(1);\nend\nfunction g(b)\na(1);\nend": 1,
        "classdef A < no.such\nend": 1,
    }.items():
        found = list(faults("a test", f"{code}\n".encode(), known, set()))
        assert len(found) == count, (code, found)


def main() -> None:
    folder = Path(sys.argv[1])
    sources = {path: path.read_bytes() for path in sorted(folder.rglob("*.m"))}
    roots = [PARSER.parse(source).root_node for source in sources.values()]
    own = {path.stem for path in folder.rglob("*.[mc]")} | {"roburoc4"}
    for root in roots:
        definitions = [node for node in below(root) if node.type == "function_definition"]
        names = [node.child_by_field_name("name") for node in definitions]
        own |= {text(name) for name in names if name is not None}
    documented = set(listed("documented/r2021a.txt"))
    marked = {name for name, note in listed("functions.txt").items() if note}
    known = reference_list() | documented
    check_itself(known)
    found = [f for p, s in sources.items() for f in faults(str(p), s, known | marked, own)]
    called = {name for root in roots for _, name in used(root)}
    idle = ", ".join(sorted(documented - called))
    if found or idle:
        sys.exit("\n".join([*found, f"in documented/r2021a.txt, but not used: {idle}"]))
    print(f"{len(sources)} files call {len((called & known) - own)} functions that R2021a has")


main()
