# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of the machine that rules read, from files of the kernel."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from smarttestudo.domain.units import BYTES_PER_GB

_MILLIDEGREES_PER_DEGREE = 1000
_LEAST_C, _MOST_C = -60.0, 125.0
"""What chips bear: a sensor that is not connected often says 127 °C."""
_WEAKEST_DBM = -150.0
_TIMES = 8
"""Times of the cores in /proc/stat; those behind are parts of them."""
_IDLE = (3, 4)
"""Which of them are idle: one waits for a disk."""
_DECIMALS = 3


class MachineVitals:
    """The machine, with the kernel's files below ``root``; of its disks, that of ``disk`` counts."""

    def __init__(self, disk: Path, root: Path = Path("/")) -> None:
        self._disk = disk
        self._proc, self._sys = root / "proc", root / "sys"
        self._times: tuple[int, int] | None = None
        self._readers: Mapping[str, Callable[[], float | None]] = {
            "cpu": self._cpu_percent,
            "memory": self._memory_percent,
            "temperature": self._temperature_c,
            "disk_free": self._disk_free_gb,
            "wifi_signal": self._wifi_signal_dbm,
        }

    def read(self, names: Collection[str]) -> dict[str, float | None]:
        """The values of these properties now; ``None`` where one cannot be had."""
        if "cpu" not in names:
            self._times = None
        return {name: self._value(self._readers[name]) for name in names if name in self._readers}

    @staticmethod
    def _value(read: Callable[[], float | None]) -> float | None:
        try:
            value = read()
        except (OSError, ArithmeticError, LookupError, ValueError):
            return None
        return None if value is None else round(value, _DECIMALS)

    def _cpu_percent(self) -> float | None:
        """How busy all cores were since the last call; unknown at the first."""
        with (self._proc / "stat").open(encoding="ascii") as file:
            times = [int(word) for word in file.readline().split()[1 : _TIMES + 1]]
        before, self._times = self._times, (sum(times), sum(times[place] for place in _IDLE))
        if before is None or self._times[0] <= before[0]:
            return None
        idle_share = (self._times[1] - before[1]) / (self._times[0] - before[0])
        # Waiting for a disk is counted by the core that began it, and may go back.
        return 100 * min(max(1 - idle_share, 0.0), 1.0)

    def _memory_percent(self) -> float:
        """Share of the memory that is neither free nor could be freed at once."""
        lines = (line.split() for line in (self._proc / "meminfo").read_text("ascii").splitlines())
        sizes = {words[0]: int(words[1]) for words in lines if len(words) > 1}
        total = sizes["MemTotal:"]
        if total <= 0:
            raise ValueError("a machine has memory")
        return 100 * min(max(1 - sizes["MemAvailable:"] / total, 0.0), 1.0)

    def _temperature_c(self) -> float | None:
        kinds = ("class/thermal/thermal_zone*/temp", "class/hwmon/hwmon*/temp*_input")
        sensors = (_sensor_c(file) for kind in kinds for file in self._sys.glob(kind))
        return max((told for told in sensors if told is not None), default=None)

    def _disk_free_gb(self) -> float:
        return shutil.disk_usage(self._disk).free / BYTES_PER_GB

    def _wifi_signal_dbm(self) -> float | None:
        """The strongest signal in /proc/net/wireless, whose first two lines are headings."""
        lines = (self._proc / "net/wireless").read_text("ascii").splitlines()[2:]
        levels = [float(line.split()[3]) for line in lines if line.strip()]
        # Above 0 it has no unit, and 0 or -256 is none.
        return max((level for level in levels if _WEAKEST_DBM <= level < 0), default=None)


def _sensor_c(file: Path) -> float | None:
    """The temperature in the file of a sensor; ``None`` for one that sleeps, or says what none has."""
    try:
        temperature_c = int(file.read_text("ascii")) / _MILLIDEGREES_PER_DEGREE
    except (OSError, ArithmeticError, ValueError):
        return None
    return temperature_c if _LEAST_C <= temperature_c < _MOST_C else None


class MachineReader:
    """Reads ``machine`` on a thread of its own, once for each time it is asked: a disk may be away."""

    def __init__(self, machine: MachineVitals) -> None:
        self._machine = machine
        self._names: Collection[str] = ()
        self._values: Mapping[str, float | None] | None = None
        self._is_asked = threading.Event()
        self._is_closed = False
        self._thread: threading.Thread | None = None

    def ask(self, names: Collection[str]) -> None:
        """Have these properties read now."""
        self._names = names
        if self._thread is None:
            self._thread = threading.Thread(target=self._read, name="machine", daemon=True)
            self._thread.start()
        self._is_asked.set()

    def take(self) -> Mapping[str, float | None] | None:
        """Values that were read since the last call; ``None``: none."""
        values, self._values = self._values, None
        return values

    def close(self) -> None:
        """Read nothing more."""
        self._is_closed = True
        self._is_asked.set()

    def _read(self) -> None:
        while self._is_asked.wait() and not self._is_closed:
            self._is_asked.clear()
            self._values = self._machine.read(self._names)
