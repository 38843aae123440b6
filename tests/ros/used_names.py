# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the adapters use of rclpy and librcl, read from their source."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path

import smarttestudo.robot.ros

ADAPTERS = Path(smarttestudo.robot.ros.__file__).parent
# What variables of these names are, wherever the adapters use them.
CLASSES = {
    "node": "rclpy.node.Node",
    "_node": "rclpy.node.Node",
    "operators": "rclpy.node.Node",
    "_operators": "rclpy.node.Node",
    "executor": "rclpy.executors.SingleThreadedExecutor",
    "_executor": "rclpy.executors.SingleThreadedExecutor",
    "_clock": "rclpy.clock.Clock",
}

Names = frozenset[str]


def used_names() -> list[Names]:
    """What is needed: one name at least of each set, of which one that is there is taken."""
    found: set[Names] = set()
    for path in sorted(ADAPTERS.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        checked = {node for one in ast.walk(tree) if is_capability_check(one) for node in ast.walk(one)}
        found |= {frozenset(names_in(ast.walk(one))) for one in ast.walk(tree) if is_capability_check(one)}
        imported = imported_classes(tree)
        found |= {
            frozenset({name})
            for node in ast.walk(tree)
            if node not in checked
            for name in (*names_in([node]), *attributes_in(node, imported))
        }
    return sorted(found - {frozenset()}, key=sorted)


def is_capability_check(node: ast.AST) -> bool:
    """Whether it imports one thing or, where that fails, another."""
    if not isinstance(node, ast.Try) or [ast.unparse(one.type or node) for one in node.handlers] != [
        "ImportError"
    ]:
        return False
    return all(isinstance(one, ast.ImportFrom) for one in (*node.body, *node.handlers[0].body))


def names_in(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """What is imported from rclpy, and the functions of librcl."""
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "rclpy":
            yield from (f"{node.module}.{one.name}" for one in node.names)
        elif (
            isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "rcl_function"
        ):
            name = node.args[1]
            assert isinstance(name, ast.Constant)
            assert isinstance(name.value, str)
            yield f"librcl.{name.value}"
        elif isinstance(node, ast.Attribute) and node.attr.startswith("rcutils_"):
            yield f"librcl.{node.attr}"


def attributes_in(node: ast.AST, imported: dict[str, str]) -> Iterator[str]:
    """What is used of rclpy's modules, of its classes and of objects with a name that is known."""
    if not isinstance(node, ast.Attribute) or node.attr.startswith("_"):
        return
    owner = node.value
    path = ast.unparse(node)
    if path.startswith("rclpy.") and path.count(".") == (2 if path.startswith("rclpy.parameter.") else 1):
        if path != "rclpy.parameter":
            yield path
    elif isinstance(owner, ast.Name) and owner.id in imported:
        yield f"{imported[owner.id]}.{node.attr}"
    name = owner.id if isinstance(owner, ast.Name) else owner.attr if isinstance(owner, ast.Attribute) else ""
    if name in CLASSES:
        yield f"{CLASSES[name]}.{node.attr}"


def imported_classes(tree: ast.AST) -> dict[str, str]:
    """Classes of rclpy by the names that a module has for them."""
    return {
        one.name: f"{node.module}.{one.name}"
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rclpy.")
        for one in node.names
    }
