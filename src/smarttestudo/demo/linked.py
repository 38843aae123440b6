# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo over a thin link: SmartTestudo's two ends, then plain Zenoh and Fast DDS with the same rules."""

from __future__ import annotations

import hashlib
import zlib
from collections import defaultdict
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

from smarttestudo.bags.reader import open_recording
from smarttestudo.demo.link_run import Contender, DrivenAcross, LinkDrive, drive_across
from smarttestudo.demo.network_namespaces import ThinLink, require_links, thin_link
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.files.removal import temporary_folder
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.report.bag_report import Progress
from smarttestudo.report.link_comparison import LinkArrivals, TopicArrivals

PROFILE = "warehouse.toml"
BYTES_PER_SECOND = 7_000_000
"""About how much disk both recordings take for each second, while they are written."""
_DIGEST_BYTES = 16
_REPEATED = -1
_LEAST_SHARE = 0.8


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkDemoRequest:
    """The link's rate, the drive, and where what our own link brought goes."""

    rate_bit_per_s: float
    seconds: float
    seed: int
    rules: Path
    when_slow: WhenSlow
    baseline: Path
    adaptive: Path
    decisions: Path
    workshop: Path
    progress: Progress


def compare_over_link(request: LinkDemoRequest) -> tuple[tuple[LinkArrivals, ...], tuple[str, ...]]:
    """Drive once with each contender; what each brought, ours first, and why others brought nothing.

    Raises:
        NetworkError: there can be no link here.
        TestudoError: one of the processes of our own link failed.
    """
    require_links()
    found, notices = [], []
    for contender in Contender:
        with temporary_folder(request.workshop, prefix=f"{contender.name.lower()}-") as folder:
            try:
                with thin_link() as link:
                    found.append(_drive(request, contender, link, folder))
            except TestudoError as error:
                if contender is Contender.TESTUDO:
                    raise
                notices.append(f"{contender.value} was not measured: {error}")
    return tuple(found), tuple(notices)


def _drive(request: LinkDemoRequest, contender: Contender, link: ThinLink, folder: Path) -> LinkArrivals:
    is_ours = contender is Contender.TESTUDO
    profile = folder / PROFILE
    profile.write_bytes(files("smarttestudo.simulation").joinpath(PROFILE).read_bytes())
    drive = LinkDrive(
        contender=contender,
        rate_bit_per_s=request.rate_bit_per_s,
        seconds=request.seconds,
        seed=request.seed,
        rules=request.rules,
        profile=profile,
        when_slow=request.when_slow,
        decisions=request.decisions if is_ours else folder / "decisions.jsonl",
        logs=folder,
    )
    with request.progress(f"Driving over {contender.value}") as report:
        driven = drive_across(drive, link, folder, report)
    arrivals = _arrivals(driven, link)
    if is_ours:
        driven.published.rename(request.baseline)
        driven.received.rename(request.adaptive)
    return LinkArrivals(name=contender.value, used=driven.used, topics=arrivals)


def _arrivals(driven: DrivenAcross, link: ThinLink) -> Mapping[str, TopicArrivals]:
    """Match what arrived with what was published, by its bytes. Raises ``NetworkError`` for another way."""
    span_s = (driven.to_ns - driven.from_ns) / NS_PER_S
    published: defaultdict[str, dict[bytes, int]] = defaultdict(dict)
    published_counts: defaultdict[str, int] = defaultdict(int)
    with open_recording(driven.published) as recording:
        for channel, stamp_ns, payload in recording.messages():
            stamps = published[channel.topic]
            digest = _digest(payload)
            # What was published twice does not say which of both arrived.
            stamps[digest] = _REPEATED if digest in stamps else stamp_ns
            published_counts[channel.topic] += driven.from_ns <= stamp_ns < driven.to_ns
    ages_ns: defaultdict[str, list[int]] = defaultdict(list)
    received_counts: defaultdict[str, int] = defaultdict(int)
    least_bytes = 0
    with open_recording(driven.received) as recording:
        for channel, stamp_ns, payload in recording.messages():
            # Both ends compress, so that no fewer than these bytes crossed the link.
            least_bytes += len(zlib.compress(payload))
            if channel.topic not in published or not driven.from_ns <= stamp_ns < driven.to_ns:
                continue
            received_counts[channel.topic] += 1
            published_ns = published[channel.topic].get(_digest(payload), _REPEATED)
            if published_ns != _REPEATED:
                ages_ns[channel.topic].append(max(0, stamp_ns - published_ns))
    link.require_carried(_LEAST_SHARE * least_bytes, driven.before_bytes)
    return {
        topic: TopicArrivals(
            published_hz=published_counts[topic] / span_s,
            received_hz=received_counts[topic] / span_s,
            ages_s=[age_ns / NS_PER_S for age_ns in sorted(ages_ns[topic])],
        )
        for topic in published
    }


def _digest(payload: bytes) -> bytes:
    return hashlib.blake2b(payload, digest_size=_DIGEST_BYTES).digest()
