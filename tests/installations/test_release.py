# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a release uploads, made by the script that makes it."""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_bytes
from pathlib import Path

from installations.environments import ROOT

PAGE = "smarttestudo/ruler/server/static/index.html"
DOCUMENTATION = "smarttestudo/ruler/server/documentation/index.html"


def test_a_release_holds_the_page_its_source_and_each_file_once(tmp_path: Path) -> None:
    done = subprocess.run(
        ["sh", "scripts/release.sh"],
        cwd=ROOT,
        env={**os.environ, "PYTHON": sys.executable, "DIST": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    wheel, source = sorted(tmp_path.iterdir())
    assert done.stdout.splitlines() == [str(wheel), str(source)]
    with zipfile.ZipFile(wheel) as opened:
        names = opened.namelist()
        (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        said = message_from_bytes(opened.read(metadata))
    assert {PAGE, DOCUMENTATION} <= set(names)
    rules = [Path(name).name for name in names if name.endswith(".adirf")]
    assert len(rules) == len(set(rules))
    assert set(rules) >= {
        path.name for path in (ROOT / "src" / "smarttestudo" / "simulation").glob("*.adirf")
    }
    assert said["License-Expression"] == "Apache-2.0"
    with tarfile.open(source) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    assert held >= {
        f"src/{PAGE}",
        f"src/{DOCUMENTATION}",
        "gui/src/app.tsx",
        "scripts/release.sh",
        "tests/conftest.py",
        "docs/index.md",
    }
    assert not {name for name in held if "node_modules" in name or "__pycache__" in name}
