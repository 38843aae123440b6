# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of the machine come from the kernel's files; what they do not say is unknown."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import pytest

from smarttestudo.robot.machine import MachineReader, MachineVitals

ALL = ("cpu", "memory", "temperature", "disk_free", "wifi_signal")
WIRELESS = """\
Inter-| sta-|   Quality        |   Discarded packets               | Missed | WE
 face | tus | link level noise |  nwid  crypt   frag  retry   misc | beacon | 22
"""


def write(root: Path, name: str, text: str) -> None:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="ascii")


def read(root: Path, name: str) -> float | None:
    return MachineVitals(root, root).read([name])[name]


def test_on_a_machine_without_any_of_these_files_all_but_the_disk_is_unknown(tmp_path: Path) -> None:
    values = MachineVitals(tmp_path, tmp_path).read(ALL)
    assert values.pop("disk_free") == pytest.approx(shutil.disk_usage(tmp_path).free / 1e9, abs=1)
    assert set(values.values()) == {None}


def test_only_what_is_asked_for_is_read(tmp_path: Path) -> None:
    machine = MachineVitals(tmp_path, tmp_path)
    assert machine.read(()) == {}
    assert machine.read(["memory", "of_no_machine"]) == {"memory": None}


def test_cpu_is_the_share_of_time_since_the_last_call_in_which_cores_were_busy(tmp_path: Path) -> None:
    machine = MachineVitals(tmp_path, tmp_path)
    # user nice system idle iowait irq softirq steal guest: a guest's time is a part of the user's.
    write(tmp_path, "proc/stat", "cpu  100 0 50 800 50 0 0 0 90 0\ncpu0 1 2 3 4\n")
    assert machine.read(["cpu"]) == {"cpu": None}
    write(tmp_path, "proc/stat", "cpu  130 10 70 820 60 5 5 0 115 0\ncpu0 1 2 3 4\n")
    assert machine.read(["cpu"]) == {"cpu": 70.0}
    assert machine.read(["cpu"]) == {"cpu": None}, "no time passed"
    write(tmp_path, "proc/stat", "cpu  140 10 70 820 30 5 5 0 115 0\n")
    assert machine.read(["cpu"]) == {"cpu": None}, "time went back"


def test_cpu_does_not_reach_over_a_time_in_which_nobody_asked(tmp_path: Path) -> None:
    machine = MachineVitals(tmp_path, tmp_path)
    write(tmp_path, "proc/stat", "cpu  0 0 0 100 0 0 0 0\n")
    machine.read(["cpu"])
    write(tmp_path, "proc/stat", "cpu  900 0 0 100 0 0 0 0\n")
    machine.read(["memory"])
    assert machine.read(["cpu"]) == {"cpu": None}


def test_memory_is_what_could_not_be_had_at_once(tmp_path: Path) -> None:
    write(tmp_path, "proc/meminfo", "MemTotal: 8000 kB\nMemFree: 100 kB\nMemAvailable: 6000 kB\n")
    assert read(tmp_path, "memory") == 25.0


def test_the_temperature_is_that_of_the_hottest_sensor_that_tells_one(tmp_path: Path) -> None:
    sensors = {
        "class/thermal/thermal_zone0/temp": "51000\n",
        "class/thermal/thermal_zone1/temp": "",
        "class/hwmon/hwmon0/temp1_input": "63125\n",
        "class/hwmon/hwmon0/temp1_crit": "100000\n",
        "class/hwmon/hwmon1/temp2_input": "127500\n",
        "class/hwmon/hwmon1/temp3_input": "-128000\n",
        "class/hwmon/hwmon2/temp1_input": "9" * 400,
    }
    for name, text in sensors.items():
        write(tmp_path, f"sys/{name}", text)
    assert read(tmp_path, "temperature") == 63.125


def test_the_wifi_signal_is_the_strongest_that_has_a_unit(tmp_path: Path) -> None:
    assert read(tmp_path, "wifi_signal") is None
    write(tmp_path, "proc/net/wireless", WIRELESS)
    assert read(tmp_path, "wifi_signal") is None
    levels = {"wlan0": -61, "wlan1": -48, "wlan2": -256, "wlan3": 40, "wlan4": 0}
    lines = (f" {name}: 0000   49.  {level}.  -256  0  0  0  0  0  0\n" for name, level in levels.items())
    write(tmp_path, "proc/net/wireless", WIRELESS + "".join(lines))
    assert read(tmp_path, "wifi_signal") == -48


def test_a_disk_that_is_gone_is_unknown(tmp_path: Path) -> None:
    assert MachineVitals(tmp_path / "gone", tmp_path).read(["disk_free"]) == {"disk_free": None}


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("proc/stat", ""),
        ("proc/stat", "cpu  all idle\n"),
        ("proc/stat", "cpu  1 2\n"),
        ("proc/meminfo", "MemTotal: 0 kB\nMemAvailable: 0 kB\n"),
        ("proc/meminfo", "MemTotal: 8000 kB\n"),
        ("proc/meminfo", "MemTotal: many\n"),
        ("proc/net/wireless", f"{WIRELESS}\n wlan0\n"),
        ("proc/net/wireless", f"{WIRELESS} wlan0: 0000 49. strong. -256\n"),
    ],
)
def test_files_that_say_something_else_are_unknown(tmp_path: Path, name: str, content: str) -> None:
    write(tmp_path, name, content)
    assert set(MachineVitals(tmp_path / "gone", tmp_path).read(ALL).values()) == {None}


@pytest.mark.skipif(sys.platform != "linux", reason="its files are Linux's")
def test_this_machine_has_a_cpu_a_memory_and_a_disk() -> None:
    machine = MachineVitals(Path())
    machine.read(["cpu"])
    values = machine.read(ALL)
    assert 0 < (values["memory"] or 0) < 100
    assert (values["disk_free"] or 0) > 0
    assert values["cpu"] is None or 0 <= values["cpu"] <= 100


def test_a_file_that_does_not_answer_keeps_nobody_waiting(tmp_path: Path) -> None:
    hanging = tmp_path / "proc/meminfo"
    hanging.parent.mkdir()
    os.mkfifo(hanging)
    reader = MachineReader(MachineVitals(tmp_path, tmp_path))
    for _ in range(3):
        reader.ask(["memory"])
        assert reader.take() is None
    hanging.write_text("MemTotal: 8 kB\nMemAvailable: 6 kB\n", encoding="ascii")
    while (values := reader.take()) is None:
        pass
    assert values == {"memory": 25.0}
    hanging.unlink()
    reader.close()
