# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A bound with dead reckoning beside fixed rates of as many messages, on public trajectories.

``python benchmarks/trajectories.py FILE…`` prints the table of docs/loss.md, which names data sets. A FILE is
one of

- KITTI odometry: poses of 12 numbers a line; the stamps are the FILE after it, or times.txt of its sequence;
- EuRoC: data.csv of a state_groundtruth_estimate0;
- TUM RGB-D: groundtruth.txt.

The twist of each pose is that from the pose before it; where a set has velocities, these are taken. Where a
set has no pose for over a second, it begins anew: nobody knows how far a picture is off then.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

from smarttestudo.accuracy.arms import Arm, PacedPicture, Strategy, rate_of_messages
from smarttestudo.accuracy.samples import Message
from smarttestudo.domain.units import NS_PER_S, grouped
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.reckoning.gauges import MovingPart, PoseState
from smarttestudo.pacing.reckoning.motion import Rotation, SpatialPose, Vector3, twist_between
from smarttestudo.pacing.sample import StreamKind

ODOMETRY = "nav_msgs/msg/Odometry"
KITTI, EUROC, TUM = "KITTI", "EuRoC", "TUM"
BOUNDS_M = {KITTI: 1.0, EUROC: 0.05, TUM: 0.05}
CM_PER_M = 100
LONGEST_GAP_NS = NS_PER_S
NO_VELOCITY = Vector3(math.nan, math.nan, math.nan)


class TrajectoryError(Exception):
    """A file is no trajectory that can be read."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A pose at a time, with the velocity in the frame of the poses, which is NaN where the set has none."""

    stamp_ns: int
    pose: SpatialPose
    velocity: Vector3

    @property
    def velocity_of_body(self) -> Vector3:
        """The velocity in the frame of what moves: its way within a second, without a turn."""
        start = SpatialPose(Vector3(0.0, 0.0, 0.0), self.pose.orientation)
        return twist_between(start, start._replace(position=self.velocity), 1.0).linear


@dataclass(frozen=True, slots=True, kw_only=True)
class Trajectory:
    """The places of a data set, by rising stamps."""

    path: Path
    form: str
    places: Sequence[Place]

    def stretches(self) -> Iterator[list[Message]]:
        """Odometry at each place, in stretches without a gap."""
        stretch: list[Place] = []
        for place in self.places:
            if stretch and place.stamp_ns - stretch[-1].stamp_ns > LONGEST_GAP_NS:
                yield list(odometry(stretch))
                stretch = []
            stretch.append(place)
        yield list(odometry(stretch))


def odometry(places: Sequence[Place]) -> Iterator[Message]:
    """Messages with the twist from the place before; the first one says that it stands."""
    for before, place in zip((places[0], *places), places, strict=False):
        elapsed_s = (place.stamp_ns - before.stamp_ns) / NS_PER_S or 1.0
        twist = twist_between(before.pose, place.pose, elapsed_s)
        if not math.isnan(place.velocity.x):
            twist = twist._replace(linear=place.velocity_of_body)
        part = MovingPart("", place.stamp_ns, ("", ""), PoseState(place.pose, twist), has_stamp=True)
        yield Message(place.stamp_ns, ((part,),))


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """The picture of a receiver of as many messages of one trajectory, sent and shown in three ways."""

    trajectory: Trajectory
    bound_m: float
    bounded: PacedPicture
    held: PacedPicture
    reckoned: PacedPicture


def trajectories(paths: Iterable[Path]) -> Iterator[Trajectory]:
    """The trajectories of files; one of times alone belongs to that before it."""
    coming = [(path, rows(path)) for path in paths]
    for number, (path, numbers) in enumerate(coming):
        columns = len(numbers[0])
        if columns == 1:
            if not number or len(coming[number - 1][1][0]) != 12:
                raise TrajectoryError(
                    f"{path}: has only times; name it after the poses of KITTI that it is of"
                )
        elif columns == 12:
            after = coming[number + 1][1] if number + 1 < len(coming) else None
            times = after if after and len(after[0]) == 1 else rows(times_of(path))
            if len(times) != len(numbers):
                raise TrajectoryError(f"{path}: has {len(numbers)} poses, and {len(times)} times")
            yield trajectory(path, KITTI, (kitti(*pair) for pair in zip(times, numbers, strict=True)))
        elif path.suffix == ".csv" and columns >= 8:
            yield trajectory(path, EUROC, map(euroc, numbers))
        elif columns == 8:
            yield trajectory(path, TUM, map(tum, numbers))
        else:
            raise TrajectoryError(f"{path}: {columns} numbers a line are neither KITTI, EuRoC nor TUM")


def rows(path: Path) -> list[list[Decimal]]:
    """The numbers of each line, without comments and lines with NaN."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        found = [
            [Decimal(word) for word in line.replace(",", " ").split()]
            for line in lines
            if line.strip() and not line.lstrip().startswith("#")
        ]
        found = [row for row in found if all(number.is_finite() for number in row)]
    except (OSError, UnicodeDecodeError, InvalidOperation) as error:
        raise TrajectoryError(f"{path}: cannot be read as lines of numbers ({error})") from error
    if not found:
        raise TrajectoryError(f"{path}: holds no numbers")
    if len({len(row) for row in found}) > 1:
        raise TrajectoryError(f"{path}: its lines have different counts of numbers")
    return found


def times_of(poses: Path) -> Path:
    """The stamps of poses/00.txt in sequences/00/times.txt, as KITTI has them, or beside the poses."""
    known = (
        poses.absolute().parents[1] / "sequences" / poses.stem / "times.txt",
        poses.with_name("times.txt"),
        poses.with_name(f"{poses.stem}_times.txt"),
    )
    found = next((path for path in known if path.is_file()), None)
    if found is None:
        raise TrajectoryError(f"{poses}: its stamps are not at {known[0]}; name their file after it")
    return found


def trajectory(path: Path, form: str, places: Iterable[Place]) -> Trajectory:
    """Those places that are later than all before, as each message is."""
    rising: list[Place] = []
    for place in places:
        if not rising or place.stamp_ns > rising[-1].stamp_ns:
            rising.append(place)
    if len(rising) < 3:
        raise TrajectoryError(f"{path}: has fewer than three poses with rising stamps")
    return Trajectory(path=path, form=form, places=rising)


def kitti(time: Sequence[Decimal], row: Sequence[Decimal]) -> Place:
    """A matrix of 3 × 4, row by row: a rotation, and the position in its last column."""
    matrix = [[float(number) for number in row[4 * line : 4 * line + 4]] for line in range(3)]
    pose = SpatialPose(Vector3(*(line[3] for line in matrix)), rotation_of(matrix))
    return Place(stamp_ns=int(time[0] * NS_PER_S), pose=pose, velocity=NO_VELOCITY)


def euroc(row: Sequence[Decimal]) -> Place:
    """A stamp in ns, a position, a quaternion from w on, and a velocity where there is one."""
    x, y, z, q_w, q_x, q_y, q_z, *more = map(float, row[1:])
    velocity = Vector3(*more[:3]) if len(more) >= 3 else NO_VELOCITY
    pose = SpatialPose(Vector3(x, y, z), Rotation(q_x, q_y, q_z, q_w))
    return Place(stamp_ns=int(row[0]), pose=pose, velocity=velocity)


def tum(row: Sequence[Decimal]) -> Place:
    """A stamp in s, a position, a quaternion."""
    numbers = [float(number) for number in row[1:]]
    pose = SpatialPose(Vector3(*numbers[:3]), Rotation(*numbers[3:]))
    return Place(stamp_ns=int(row[0] * NS_PER_S), pose=pose, velocity=NO_VELOCITY)


def rotation_of(matrix: Sequence[Sequence[float]]) -> Rotation:
    """The quaternion of a rotation, by its greatest component, which no rounding makes 0."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = (line[:3] for line in matrix)
    squares = {"w": 1 + xx + yy + zz, "x": 1 + xx - yy - zz, "y": 1 - xx + yy - zz, "z": 1 - xx - yy + zz}
    greatest = max(squares, key=lambda name: squares[name])
    by_greatest = {
        "w": (zy - yz, xz - zx, yx - xy, squares["w"]),
        "x": (squares["x"], xy + yx, xz + zx, zy - yz),
        "y": (xy + yx, squares["y"], yz + zy, xz - zx),
        "z": (xz + zx, yz + zy, squares["z"], yx - xy),
    }[greatest]
    return Rotation(*(part / math.hypot(*by_greatest) for part in by_greatest))


def compare(trajectory: Trajectory, bound_m: float) -> Comparison:
    """Send a trajectory within the bound, then at the fixed rate of as many messages."""
    gauges = gauges_for(ODOMETRY, ["position"])

    def sent(messages: Sequence[Message], strategy: Strategy) -> PacedPicture:
        arm = Arm(Estimate(gauges, reckons=strategy.reckons), "position", StreamKind.VOLATILE, strategy)
        for message in messages:
            arm.send(message)
        return arm.finish(messages[-1].stamp_ns)

    stretches = [one for one in trajectory.stretches() if len(one) > 1]
    lasted_ns = [one[-1].stamp_ns - one[0].stamp_ns for one in stretches]
    ways: list[list[PacedPicture]] = [[], [], []]
    for stretch in stretches:
        bounded = sent(stretch, Strategy(reckons=True, bound=bound_m))
        stamps_ns = [message.stamp_ns for message in stretch]
        rate_hz = rate_of_messages(
            bounded.messages, stamps_ns, end_ns=stamps_ns[-1], kind=StreamKind.VOLATILE, frames=()
        )
        ways[0].append(bounded)
        ways[1].append(sent(stretch, Strategy(reckons=False, rate_hz=rate_hz)))
        ways[2].append(sent(stretch, Strategy(reckons=True, rate_hz=rate_hz)))
    bounded, held, reckoned = (together(pictures, lasted_ns) for pictures in ways)
    return Comparison(trajectory=trajectory, bound_m=bound_m, bounded=bounded, held=held, reckoned=reckoned)


def together(pictures: Sequence[PacedPicture], lasted_ns: Sequence[int]) -> PacedPicture:
    """The picture of all stretches, each as long as it lasted."""
    squares = sum(lasted * one.rmse**2 for one, lasted in zip(pictures, lasted_ns, strict=True))
    return PacedPicture(
        messages=sum(one.messages for one in pictures),
        rmse=math.sqrt(squares / sum(lasted_ns)),
        worst=max(one.worst for one in pictures),
        unknown=sum(one.unknown for one in pictures),
    )


def table(compared: Iterable[Comparison]) -> Iterator[str]:
    """The lines of the Markdown table: RMSE and worst in cm, the last columns against the bound."""
    yield "| data | poses | bound | sent | bound, reckoned | fixed, hold | fixed, reckoned | RMSE | worst |"
    yield "|---|---:|---:|---:|---:|---:|---:|---:|---:|"
    for one in compared:
        poses = len(one.trajectory.places)
        ways = (one.bounded, one.held, one.reckoned)
        cells = (
            f"{one.trajectory.form}, {one.trajectory.path.name}",
            grouped(poses),
            f"{CM_PER_M * one.bound_m:g}",
            f"{grouped(one.bounded.messages)}, {100 * one.bounded.messages / poses:.1f} %",
            *(f"{CM_PER_M * way.rmse:.1f}, {CM_PER_M * way.worst:.1f}" for way in ways),
            times(one.reckoned.rmse, one.bounded.rmse),
            times(one.reckoned.worst, one.bounded.worst),
        )
        yield f"| {' | '.join(cells)} |"


def times(error: float, least: float) -> str:
    return f"{error / least:.1f} times" if least else "–"


def main() -> int:
    assert __doc__ is not None
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("files", metavar="FILE", nargs="*", type=Path, help="poses of KITTI, EuRoC or TUM")
    parser.add_argument(
        "--bound", metavar="M", type=float, help="of the position (default: KITTI 1, else 0.05)"
    )
    arguments = parser.parse_args()
    if not arguments.files:
        print("Name files of trajectories; docs/loss.md says where to download them.")
        return 0
    try:
        read = list(trajectories(arguments.files))
    except TrajectoryError as error:
        sys.exit(f"error: {error}")
    for line in table(compare(one, arguments.bound or BOUNDS_M[one.form]) for one in read):
        print(line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
