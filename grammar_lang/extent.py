"""Bounds on the depth and size of expressions, so that every later walk may recurse."""

from __future__ import annotations

from grammar_lang import ir

MAX_DEPTH = 120
MAX_NODES = 20_000


def children(expr: ir.Expr) -> tuple[ir.Expr, ...]:
    """The direct subexpressions of an expression."""
    match expr:
        case ir.Unary(operand=part) | ir.Rot(angle=part) | ir.Move(distance=part):
            return (part,)
        case ir.Shift(vector=part):
            return (part,)
        case ir.Binary(left=left, right=right) | ir.Compose(left=left, right=right):
            return (left, right)
        case ir.Vector(x=x, y=y, z=z):
            return (x, y, z)
        case _:
            return ()


def too_large(expr: ir.Expr) -> bool:
    """Whether an expression exceeds ``MAX_DEPTH`` or, as a tree, ``MAX_NODES``."""
    stack = [(expr, 0)]
    seen = 0
    while stack:
        node, depth = stack.pop()
        seen += 1
        if depth > MAX_DEPTH or seen > MAX_NODES:
            return True
        stack.extend((child, depth + 1) for child in children(node))
    return False
