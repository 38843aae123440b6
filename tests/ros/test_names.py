# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All that the adapters use of ROS 2 is there in each distribution, by tables read from its sources.

``names/*.json`` say of each distribution which of those names it has, and where that was read.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.metadata
import json
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from ros.used_names import ADAPTERS, used_names

TABLES = {
    path.stem: json.loads(path.read_text(encoding="utf-8"))
    for path in sorted((Path(__file__).parent / "names").glob("*.json"))
}
BY_MAJOR_VERSION = {3: "humble", 7: "jazzy", 9: "kilted"}
# Hides of each module that the adapters import what a distribution lacks, and then imports the adapters.
IMPORTS = """
import importlib, sys, types
names, used, adapters = (argument.split(",") for argument in sys.argv[1:])
for name in used:
    module, _, attribute = name.rpartition(".")
    if module + "." + attribute in names:
        continue
    importlib.import_module("rclpy.node")
    if any(one.startswith(module + ".") for one in names):
        delattr(importlib.import_module(module), attribute)
    else:
        sys.modules[module] = None
for name in set(names) - set(used):
    sys.exit(f"{name} is not used")
for name in names:
    module, _, attribute = name.rpartition(".")
    try:
        getattr(importlib.import_module(module), attribute)
    except ImportError:
        sys.modules[module] = stub = types.ModuleType(module)
        setattr(stub, attribute, object)
for adapter in adapters:
    importlib.import_module(adapter)
"""


def test_there_is_a_table_of_each_distribution() -> None:
    assert set(TABLES) == {"humble", "jazzy", "kilted", "lyrical", "rolling"}
    assert all(table["sources"]["rclpy"] and table["sources"]["librcl"] for table in TABLES.values())


@pytest.mark.parametrize("distribution", TABLES)
def test_whatever_is_used_is_there_or_stands_behind_a_check(distribution: str) -> None:
    there = set(TABLES[distribution]["names"])
    assert [sorted(names) for names in used_names() if not names & there] == []


@pytest.mark.parametrize("distribution", TABLES)
def test_the_adapters_can_be_imported_where_what_a_distribution_lacks_is_hidden(distribution: str) -> None:
    paths = [path.relative_to(ADAPTERS).with_suffix("") for path in sorted(ADAPTERS.rglob("[a-z]*.py"))]
    modules = [".".join(("smarttestudo.robot.ros", *path.parts)) for path in paths]
    names = [name for name in TABLES[distribution]["names"] if is_import(name)]
    used = sorted(name for choice in used_names() for name in choice if is_import(name))
    arguments = [",".join(part) for part in (names, used, modules)]
    command = [sys.executable, "-c", IMPORTS, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_table_of_the_ros_that_is_installed_is_right() -> None:
    distribution = installed_distribution()
    if distribution is None:
        return
    there = TABLES[distribution]["names"]
    assert [name for choice in used_names() for name in choice if is_there(name) != (name in there)] == []


def is_import(name: str) -> bool:
    """Whether it is a name of one of rclpy's modules, and not of a class there."""
    return name.startswith("rclpy.") and name.count(".") == 2


def installed_distribution() -> str | None:
    """The distribution that this rclpy is of, if there is a table of it."""
    return BY_MAJOR_VERSION.get(int(importlib.metadata.version("rclpy").partition(".")[0]))


def is_there(name: str) -> bool:
    """Whether the installed ROS has it."""
    if name.startswith("librcl."):
        importlib.import_module("rclpy")
        return hasattr(ctypes.CDLL("librcl.so"), name.removeprefix("librcl."))
    parts = name.split(".")
    depth = 1 if len(parts) == 2 else 2
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            thing = importlib.import_module(".".join(parts[:depth]))
        for part in parts[depth:]:
            # The clock of a node is a subclass, which has more.
            thing = getattr(thing, "ROSClock" if part == "Clock" else part)
    except (ImportError, AttributeError):
        return False
    return True
