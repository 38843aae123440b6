# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is there for a TurtleBot3: launch file, world and profiles. Gazebo itself is not run here."""

from __future__ import annotations

import ast
import runpy
from pathlib import Path
from xml.etree import ElementTree

import pytest

from ros_package.workspace import ROOT
from smarttestudo.cli.main import main
from smarttestudo.domain.floor_plan import ObstacleKind, Point, Rectangle
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.simulation.messages import PATROL_TOPICS
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.warehouse import warehouse

LAUNCH_FILES = sorted((ROOT / "launch").glob("*.launch.py"))
WORLD = ROOT / "worlds" / "warehouse.sdf"
PRESETS = ROOT / "src/smarttestudo/rules/presets"
REAL, SIMULATED = (PRESETS / name for name in ("turtlebot3.toml", "turtlebot3_gazebo.toml"))
RULES = ROOT / "examples" / "warehouse.adirf"


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_a_launch_file_compiles_and_describes_a_launch(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"), path)
    compile(tree, path, "exec")
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert "generate_launch_description" in functions


def path_in_source(folder: str, name: str) -> Path:
    """Where the checkout has what is shared."""
    return (PRESETS if folder == "profiles" else ROOT / folder) / name


def test_a_launch_file_names_only_files_that_the_package_shares() -> None:
    named = [
        path_in_source(*[ast.literal_eval(part) for part in call.args[1:]])
        for path in LAUNCH_FILES
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Name)
        and call.func.id == "shared"
        and isinstance(call.args[0], ast.Constant)
        and call.args[0].value == "smarttestudo"
    ]
    assert len(named) == 4
    assert [path for path in named if not path.is_file()] == []


def test_the_world_is_what_make_docs_writes() -> None:
    make_world = runpy.run_path(str(ROOT / "scripts" / "make_world.py"))["world"]
    assert WORLD.read_text(encoding="utf-8") == make_world(warehouse())


def test_every_obstacle_of_the_floor_plan_is_seen_and_felt_in_the_world() -> None:
    plan, world = warehouse(), ElementTree.parse(WORLD).getroot()
    for kind in ObstacleKind:
        boxes = [
            " ".join(f"{number:g}" for number in (x_m, y_m, one.height_m / 2))
            for one in plan.obstacles
            if one.kind is kind
            for x_m, y_m in [middle(one.footprint)]
        ]
        for part in ("collision", "visual"):
            poses = world.findall(f".//model[@name='{kind.value}s']/link/{part}/pose")
            assert [(pose.text or "").removesuffix(" 0 0 0") for pose in poses] == boxes


def middle(footprint: Rectangle) -> tuple[float, float]:
    centre_x_m = (footprint.min_x_m + footprint.max_x_m) / 2
    return round(centre_x_m, 3), round((footprint.min_y_m + footprint.max_y_m) / 2, 3)


def test_a_turtlebot3_fits_where_the_launch_file_puts_it() -> None:
    assert warehouse().clearance_m(Point(0.0, 0.0)) > 2 * DriveModel().radius_m


def test_the_profiles_know_the_topics_of_a_turtlebot3() -> None:
    # The fixed frames come once, so no budget counts them.
    topics = {topic.value for topic in PATROL_TOPICS} - {"/tf_static"}
    assert set(load_profile(SIMULATED).topics) == topics
    assert set(load_profile(REAL).topics) == topics | {"/battery_state"}


def test_the_real_robot_has_its_own_rates_and_sizes() -> None:
    real, simulated = load_profile(REAL), load_profile(SIMULATED)
    assert [real.topic(name).source_hz for name in ("/imu", "/joint_states")] == [20, 20]
    assert [simulated.topic(name).source_hz for name in ("/imu", "/joint_states")] == [195, 5]
    header_kb = 0.052
    assert real.topic("/camera/image_raw").message_kb == 640 * 480 * 3 / 1000 + header_kb


@pytest.mark.parametrize("profile", [REAL, SIMULATED], ids=lambda path: path.name)
def test_the_warehouse_rules_fit_the_profile(profile: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(RULES), "--profile", str(profile)]) == 0
    printed = capsys.readouterr().out
    assert "fits the budget in every situation" in printed
    assert "warning" not in printed
    assert main(["optimize", str(RULES), "--profile", str(profile)]) == 0
