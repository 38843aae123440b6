# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Print what each part of the tests took and its result, the ten slowest tests, and which failed.

usage: slowest_tests.py REPORT.xml ...
The reports are those of ``pytest --junitxml``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

SHOWN = 10


def name_of(case: ElementTree.Element) -> str:
    """The test as ``pytest`` would be asked for it, but for a class."""
    return f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}"


def main(paths: list[Path]) -> None:
    """Print it of these reports."""
    cases: list[ElementTree.Element] = []
    print("\nPart      Tests  Failed   Wall (s)")
    for path in paths:
        for suite in ElementTree.parse(path).getroot().iter("testsuite"):
            failures = int(suite.get("failures", 0)) + int(suite.get("errors", 0))
            print(
                f"{path.stem:8}  {suite.get('tests'):>5}  {failures:>6}   {float(suite.get('time', 0)):8.1f}"
            )
            cases += suite.iter("testcase")
    print(f"\nThe {SHOWN} slowest tests (s)")
    for case in sorted(cases, key=lambda case: -float(case.get("time", 0)))[:SHOWN]:
        print(f"{float(case.get('time', 0)):6.1f}  {name_of(case)}")
    for case in cases:
        if case.find("failure") is not None or case.find("error") is not None:
            print(f"FAILED  {name_of(case)}")


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]])
