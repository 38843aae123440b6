# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The shared files of the ROS package, compiled relays, a wheel's page; pyproject.toml where none reads it.

Setuptools before 61 (ROS 2 Humble's) does not know pyproject.toml, and ``colcon build --symlink-install``
runs a link to this file in another folder.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import setuptools
from setuptools import Distribution, Extension
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:
    # Older ones have it elsewhere, or not at all, and then make no wheels.
    try:
        from wheel.bdist_wheel import bdist_wheel
    except ImportError:
        bdist_wheel = object

# Below setuptools, which provides it where Python no longer does.
from distutils.command.install_data import install_data  # isort: skip

ROOT = Path(__file__).resolve().parent
SHARE = "share/smarttestudo"
SHARED_FOLDERS = (
    *("launch", "worlds", "examples", "examples/quality"),
    *("extras", "extras/grafana", "extras/vscode"),
)
PRESETS = "src/smarttestudo/rules/presets"
SETUPTOOLS = int(setuptools.__version__.partition(".")[0])
FIRST_TO_READ_PYPROJECT = 61
FIRST_WITH_EXPRESSIONS = 77
SERVER = ROOT / "src" / "smarttestudo" / "ruler" / "server"
MADE = (
    ("page", "gui", SERVER / "static" / "index.html", ROOT / "scripts" / "make_gui.sh"),
    (
        *("documentation", "documentation"),
        SERVER / "documentation" / "index.html",
        ROOT / "scripts" / "make_documentation.sh",
    ),
)
"""What the Ruler shows: its name, the target of make, its beginning, and what makes it."""
MADE_WITHIN_S = 600
RCL = "src/smarttestudo/robot/ros/rcl"
RELAYS = Extension("smarttestudo.robot.ros.rcl.relay", [f"{RCL}/relay.c", f"{RCL}/copies.c"])
RELAY_FLAGS = ("-std=c11", "-O2", "-shared", "-fPIC", "-pthread")
WITHOUT_RELAYS = "SMARTTESTUDO_WITHOUT_RELAYS"
"""If the environment has it, nothing is compiled, and a wheel is for every machine."""


def shared_files() -> list[tuple[str, list[str]]]:
    """What goes to share, by folder."""
    return [
        ("share/ament_index/resource_index/packages", ["resource/smarttestudo"]),
        (SHARE, ["package.xml"]),
        *((f"{SHARE}/{folder}", files_in(folder)) for folder in SHARED_FOLDERS),
        (f"{SHARE}/profiles", files_in(PRESETS)),
    ]


def files_in(folder: str) -> list[str]:
    """The files of a folder, from here."""
    return sorted(f"{folder}/{path.name}" for path in (ROOT / folder).iterdir() if path.is_file())


def reads_pyproject() -> bool:
    """Whether setuptools finds and understands pyproject.toml."""
    return SETUPTOOLS >= FIRST_TO_READ_PYPROJECT and Path("pyproject.toml").exists()


def licence() -> dict[str, str]:
    """The licence as setuptools wants it: Jazzy's refuses an expression, later ones all else."""
    return {"license_expression" if SETUPTOOLS >= FIRST_WITH_EXPRESSIONS else "license": "Apache-2.0"}


def from_pyproject() -> dict[str, Any]:
    """What an installation needs of pyproject.toml."""
    pyproject = toml_parser().loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project, tool = pyproject["project"], pyproject["tool"]["setuptools"]
    (source,) = tool["packages"]["find"]["where"]
    package = ROOT / source / project["name"]
    version = re.search(r'__version__ = "(.+)"', (package / "__init__.py").read_text(encoding="utf-8"))
    patterns = tool["package-data"][project["name"]]
    return {
        "name": project["name"],
        "version": version[1],
        "package_dir": {"": source},
        "packages": setuptools.find_packages(str(ROOT / source)),
        "package_data": {
            project["name"]: [
                str(path.relative_to(package)) for one in patterns for path in package.glob(one)
            ]
        },
        "extras_require": {"test": project["optional-dependencies"]["test"]},
        "entry_points": {
            group: [f"{name} = {to}" for name, to in entries.items()]
            for group, entries in {"console_scripts": project["scripts"], **project["entry-points"]}.items()
        },
    }


def toml_parser() -> Any:
    """The standard library's, from Python 3.11 on."""
    try:
        import tomllib  # noqa: PLC0415  not before Python 3.11
    except ImportError:
        try:
            import tomli as tomllib  # noqa: PLC0415  what it was before
        except ImportError:
            sys.exit("setup.py: error: Python 3.10 needs tomli; sudo apt install python3-tomli")
    return tomllib


def is_wheel(distribution: Distribution) -> bool:
    """Whether a wheel is made, and not a robot's workspace or a link to a checkout."""
    return "bdist_wheel" in distribution.commands


class BuildWithPage(build_py):
    """Builds the Ruler's page and documentation into a wheel; colcon and a link to a checkout go without."""

    def run(self) -> None:
        """Build them where they are missing and can be built, then what is always built."""
        if is_wheel(self.distribution):
            make_page()
        super().run()


class CompileRelays(build_ext):
    """Compiles relays, which call nothing of Python; where that fails, they are not installed."""

    def build_extension(self, ext: Extension) -> None:
        """Compile it by the compiler of the system, or the one in CC."""
        made = Path(self.get_ext_fullpath(ext.name))
        made.parent.mkdir(parents=True, exist_ok=True)
        compiler = shlex.split(os.environ.get("CC", "cc"))
        try:
            subprocess.run(  # noqa: S603  who installs chooses the compiler
                [*compiler, *RELAY_FLAGS, *ext.sources, "-o", str(made)], stdout=sys.stderr, check=True
            )
        except (OSError, subprocess.CalledProcessError) as error:
            sys.stderr.write(f"{error}\nwarning: no compiled relays, which need a C compiler\n")

    def get_ext_filename(self, fullname: str) -> str:
        """The library's name, which has no version of Python in it."""
        return f"{fullname.replace('.', os.sep)}.so"

    def copy_extensions_to_source(self) -> None:
        """Put it beside its source, where the package is installed as a link to a checkout."""
        if self.has_made_all():
            super().copy_extensions_to_source()

    def get_outputs(self) -> list[str]:
        """What was compiled."""
        return super().get_outputs() if self.has_made_all() else []

    def get_output_mapping(self) -> dict[str, str]:
        """What was compiled, and where it goes in a checkout."""
        return super().get_output_mapping() if self.has_made_all() else {}

    def has_made_all(self) -> bool:
        """Whether it could be compiled."""
        names = [self.get_ext_filename(ext.name) for ext in self.extensions]
        return all(Path(self.build_lib, name).exists() for name in names)


class WheelOfAnyPython(bdist_wheel):
    """A wheel for any Python; with compiled relays it is for one kind of machine, without for all."""

    def get_tag(self) -> tuple[str, str, str]:
        """For whom the wheel is."""
        _, _, platform = super().get_tag()
        return "py3", "none", platform if any(Path(self.bdist_dir).rglob("relay.so")) else "any"


class ShareWithWorkspace(install_data):
    """Installs the shared files into a workspace; a wheel holds the package, where ROS looks for none."""

    def run(self) -> None:
        """Install them, but not into a wheel."""
        if not is_wheel(self.distribution):
            super().run()


class SourceWithPage(sdist):
    """Puts page and documentation into a source archive: a wheel is built from that, often without Node."""

    def run(self) -> None:
        """Build them where they are missing; without them there is no archive."""
        make_page()
        for name, target, made, _ in MADE:
            if not made.exists():
                need = f"a release needs the {name} of 'testudo ruler'"
                sys.exit(f"setup.py: error: {need}; run 'make {target}' first")
        super().run()


def make_page() -> None:
    """Build what is missing of the page and its documentation; a wheel goes without what cannot be built."""
    for name, target, made, script in MADE:
        if script.exists() and not made.exists():
            make(script)
        if not made.exists():
            sys.stderr.write(
                f"warning: no {name} for 'testudo ruler': run 'make {target}' here and install again\n"
            )
            # Without the page nothing opens the documentation.
            return


def make(script: Path) -> None:
    """Run a script of this checkout."""
    shell = shutil.which("sh")
    if shell is None:
        return
    try:
        # What it prints must not mix with what setuptools tells pip.
        subprocess.run(  # noqa: S603  our own script
            [shell, str(script)],
            cwd=ROOT,
            env={"PYTHON": sys.executable, **os.environ},
            stdout=sys.stderr,
            timeout=MADE_WITHIN_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        sys.stderr.write(f"{error}\n")


def install() -> None:
    """Do what pip or colcon asks."""
    if not reads_pyproject():
        setuptools.setup(**OWN, **licence(), **from_pyproject())
        return
    # Who builds a workspace need not know that setuptools calls this part of pyproject.toml beta.
    warnings.filterwarnings("ignore", message=r"Support for `\[tool\.setuptools\]`")
    distribution = setuptools.setup(**OWN, **licence())
    # colcon reads a distribution back as literals, and setuptools makes an object of requires-python.
    for owner in (distribution, distribution.metadata):
        owner.python_requires = str(owner.python_requires)


COMMANDS = {
    "bdist_wheel": WheelOfAnyPython,
    "build_ext": CompileRelays,
    "build_py": BuildWithPage,
    "install_data": ShareWithWorkspace,
    "sdist": SourceWithPage,
}
OWN = {
    "data_files": shared_files(),
    "cmdclass": COMMANDS,
    "ext_modules": [RELAYS] if sys.platform == "linux" and WITHOUT_RELAYS not in os.environ else [],
}

install()
