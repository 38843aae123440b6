# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Demos as the documents show them, each made once for a whole run of the tests."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import pytest

from made_once import made_once

EXAMPLES = Path(__file__).parents[1] / "examples"
TESTUDO = "import sys; from smarttestudo.cli.main import main; sys.exit(main())"


@dataclass(frozen=True, kw_only=True)
class Ran:
    """What a command printed and how it ended."""

    code: int
    stdout: str
    stderr: str


def run_testudo_in(folder: Path, *arguments: str) -> Ran:
    """``testudo`` as its user starts it in ``folder``, with nothing on a terminal of 100 columns."""
    environment = {**os.environ, "NO_COLOR": "1", "COLUMNS": "100", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, "-c", TESTUDO, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    return Ran(code=done.returncode, stdout=done.stdout, stderr=done.stderr)


def made_demo(factory: pytest.TempPathFactory, *options: str) -> tuple[Path, Ran]:
    """The folder beside ``examples`` that ``testudo demo OPTIONS`` made there, and what that said."""

    def make(folder: Path) -> None:
        desk = folder / "desk"
        shutil.copytree(EXAMPLES, desk / "examples")
        ran = run_testudo_in(desk, "demo", *options)
        (folder / "ran.json").write_text(json.dumps(asdict(ran)), encoding="utf-8")

    folder = made_once(factory, re.sub(r"\W+", "-", " ".join(("demo", *options))), make)
    ran = Ran(**json.loads((folder / "ran.json").read_text(encoding="utf-8")))
    return folder / "desk" / "demo-out", ran
