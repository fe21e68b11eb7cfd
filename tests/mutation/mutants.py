"""Which mutants are tried: cosmic-ray's and two of tables, but those that no test should have to notice."""

from __future__ import annotations

import ast
import random
import re
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.operators.operator import Operator
from cosmic_ray.plugins import get_operator, operator_names
from parso.python.tree import Name
from parso.tree import NodeOrLeaf

SEED = 0
BITS = "LShift|RShift|BitAnd|BitOr|BitXor"
SENSELESS = re.compile(
    # bit operations between floats, which any test would notice by a TypeError
    rf"core/ReplaceBinaryOperator_(Add|Sub|Mul|Div|FloorDiv|Mod|Pow)_({BITS})"
    # identity for equality and the reverse, which are one for enumerations and None
    r"|core/ReplaceComparisonOperator_((Eq|NotEq|[LG]tE?)_Is(Not)?|Is(Not)?_(Eq|NotEq|[LG]tE?))"
    r"|core/RemoveDecorator"  # decorators are left out as a whole
)
Place = tuple[int, int]
Span = tuple[Place, Place]


@dataclass(frozen=True)
class Mutant:
    """The change that an operator makes at one of the places where it can."""

    module: Path
    operator: Operator
    occurrence: int


class TableOperator(Operator):  # type: ignore[misc]
    """Replaces nodes of a table by a text."""

    text: str

    def mutation_positions(self, node: NodeOrLeaf) -> Iterator[Span]:
        """The place of a node that may be replaced."""
        if self.takes(node):
            yield node.start_pos, node.end_pos

    def mutate(self, node: NodeOrLeaf, index: int) -> NodeOrLeaf:
        """The text instead of the node, behind the same white space."""
        return Name(self.text, node.start_pos, prefix=node.get_first_leaf().prefix)

    @classmethod
    def examples(cls) -> tuple[()]:
        """None: cosmic-ray has them for tests of its own operators."""
        return ()

    @abstractmethod
    def takes(self, node: NodeOrLeaf) -> bool:
        """Whether the node may be replaced."""


class RowLeftOut(TableOperator):
    """Leaves an entry of a tuple out that is a call or an unpacked iterable."""

    text = "*()"

    def takes(self, node: NodeOrLeaf) -> bool:
        """Whether the node is such an entry."""
        is_entry = node.parent is not None and node.parent.type == "testlist_comp"
        return (
            is_entry
            and node.type in ("atom_expr", "star_expr")
            and node.parent.parent.children[0].value == "("
            and node.parent.children[-1].type != "sync_comp_for"
        )


class GuardLeftOut(TableOperator):
    """Leaves the guard of a transition out."""

    text = "None"

    def takes(self, node: NodeOrLeaf) -> bool:
        """Whether the node is an argument that names a guard."""
        is_argument = node.parent is not None and node.parent.type == "arglist"
        return is_argument and node.type == "atom_expr" and node.get_code().strip().startswith("Guard.")


def mutants(modules: Sequence[Path], most: int) -> list[Mutant]:
    """At most so many mutants of the modules, drawn by a fixed seed."""
    found = [mutant for module in modules for mutant in _of_module(module)]
    return found if len(found) <= most else random.Random(SEED).sample(found, most)


def _operators() -> Iterator[Operator]:
    for name in sorted(operator_names()):
        operator = get_operator(name)
        if not SENSELESS.fullmatch(name) and not operator.arguments():
            yield operator()
    yield from (RowLeftOut(), GuardLeftOut())


def _of_module(module: Path) -> Iterator[Mutant]:
    spans = list(_left_out(ast.parse(module.read_text(encoding="utf-8"))))
    nodes = list(ast_nodes(get_ast_from_path(module)))
    for operator in _operators():
        places = (place for node in nodes for place in operator.mutation_positions(node))
        for occurrence, (start, end) in enumerate(places):
            if not any(first <= start and end <= last for first, last in spans):
                yield Mutant(module, operator, occurrence)


def _left_out(tree: ast.Module) -> Iterator[Span]:
    """Places whose mutants no test should have to notice.

    These are annotations, texts, what an error says, assertions for the type checker, decorators, which are
    promises to readers, and the defaults and bounds of parameters, which are data.
    """
    for node in ast.walk(tree):
        match node:
            case ast.AnnAssign(annotation=annotation) | ast.arg(annotation=ast.expr() as annotation):
                yield _span(annotation)
            case ast.FunctionDef(returns=ast.expr() as annotation):
                yield _span(annotation)
            case ast.JoinedStr() | ast.Raise() | ast.Assert() | ast.Call(func=ast.Name(id="Field")):
                yield _span(node)
            case ast.ClassDef(decorator_list=[*decorators]):
                yield from map(_span, decorators)


def _span(node: ast.expr | ast.stmt) -> Span:
    assert node.end_lineno is not None
    assert node.end_col_offset is not None
    return (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
