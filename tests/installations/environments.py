# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fresh environments, as the documentation says how to make them, and a checkout to install from."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import tomli

from forked_python import NOT_INHERITED

ROOT = Path(__file__).resolve().parents[2]
BUILT = tuple(f"src/smarttestudo/ruler/server/{name}" for name in ("static", "documentation"))
LIMIT_S = 300
UV = [sys.executable, "-m", "uv"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Environment:
    """A virtual environment in ``folder``; its commands run in ``desk``, which holds the examples.

    With a ``workspace`` ``testudo`` is what colcon built there, and the environment holds what that needs.
    """

    folder: Path
    desk: Path
    workspace: Path | None = None

    @property
    def python(self) -> str:
        return str(self.folder / "bin" / "python")

    @property
    def variables(self) -> dict[str, str]:
        """What the setup file of the workspace sets."""
        if self.workspace is None:
            return {}
        (packages,) = self.workspace.glob("lib/python*/site-packages")
        return {"PYTHONPATH": str(packages)}

    def command(self, *arguments: str | Path) -> list[str]:
        """The command line of ``testudo`` with ``arguments``."""
        programs = self.folder / "bin" if self.workspace is None else self.workspace / "lib" / "smarttestudo"
        return [self.python, str(programs / "testudo"), *map(str, arguments)]

    def run(self, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
        """``testudo`` with ``arguments``, ended."""
        return run(self.command(*arguments), cwd=self.desk, variables=self.variables)

    def does(self, *arguments: str | Path) -> str:
        """What ``testudo`` prints, which must succeed."""
        done = self.run(*arguments)
        assert done.returncode == 0, f"{' '.join(map(str, arguments))}: {done.stdout}{done.stderr}"
        return done.stdout

    def refuses(self, *arguments: str | Path) -> str:
        """The one line in which ``testudo`` refuses."""
        done = self.run(*arguments)
        assert done.returncode == 1, f"{' '.join(map(str, arguments))}: {done.stdout}{done.stderr}"
        (line,) = done.stderr.splitlines()
        return line


def clean_variables() -> Mapping[str, str]:
    """The variables of a shell in which no environment is active."""
    dropped = {*NOT_INHERITED, "PYTHONPATH", "VIRTUAL_ENV", "PYTHONHOME"}
    return {name: value for name, value in os.environ.items() if name not in dropped}


def with_python3() -> Mapping[str, str]:
    """With these ``python3`` in a shell is the Python of the tests, and pip compiles nothing."""
    programs = Path(sys.executable).resolve().parent
    return {"PATH": f"{programs}{os.pathsep}{os.environ['PATH']}", "PIP_NO_COMPILE": "1"}


def run(
    command: list[str], *, cwd: Path, variables: Mapping[str, str] = MappingProxyType({})
) -> subprocess.CompletedProcess[str]:
    """A command of a shell in which no environment is active, ended within some minutes."""
    return subprocess.run(
        command,
        cwd=cwd,
        env={**clean_variables(), **variables},
        capture_output=True,
        text=True,
        check=False,
        timeout=LIMIT_S,
    )


def copy_checkout(folder: Path, *, with_page: bool = True) -> None:
    """What a clone holds, and the page and its documentation if they were built."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in filter(None, files.stdout.split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    for built in BUILT if with_page else ():
        if (ROOT / built).is_dir():
            shutil.copytree(ROOT / built, folder / built)


def make_wheel(folder: Path) -> None:
    """What pip makes of a checkout before it installs that."""
    copy_checkout(folder / "checkout")
    does([*UV, "build", "--quiet", "--wheel", "--out-dir", str(folder)], cwd=folder / "checkout")


def make_environment(folder: Path, *requirements: str) -> None:
    """What ``python3 -m venv`` and ``pip install`` make; uv does it in a tenth of the time."""
    does([*UV, "venv", "--quiet", "--python", sys.executable, str(folder)], cwd=folder)
    python = str(folder / "bin" / "python")
    does([*UV, "pip", "install", "--quiet", "--python", python, *requirements], cwd=folder)


def does(command: list[str], *, cwd: Path, variables: Mapping[str, str] = MappingProxyType({})) -> str:
    """What a command prints, which must succeed."""
    done = run(command, cwd=cwd, variables=variables)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


def ros_packages() -> list[str]:
    """What the extra ``ros`` installs of ROS 2: what a robot has."""
    project = tomli.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [one for one in project["optional-dependencies"]["ros"] if one.startswith("ros-")]
