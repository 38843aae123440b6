# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The load of blocks together: every situation that the rules allow, and which break the budget."""

from __future__ import annotations

import bisect
import heapq
import itertools
import math
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import ArrivalProperty, Signal, Value
from smarttestudo.language.boxes import Box, Domain, Effort, TooComplexError, boxes_where
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.normal_form import reads, signals_of
from smarttestudo.language.region import Bound, Region
from smarttestudo.language.rule_set import RuleBlock, RuleSet
from smarttestudo.language.text_region import SetOfValues, TextRegion
from smarttestudo.optimizer.problem import fits
from smarttestudo.pacing.bound import HEARTBEAT_HZ


@dataclass(frozen=True, slots=True, kw_only=True)
class Cluster:
    """Blocks with all signals that they read and all topics that they set, sorted."""

    blocks: tuple[RuleBlock, ...]
    signals: tuple[Signal, ...]
    topics: tuple[str, ...]


def clusters_of(blocks: Sequence[RuleBlock]) -> list[Cluster]:
    """The clusters of ``blocks``, in the order of their first blocks."""
    parents: dict[Hashable, Hashable] = {}

    def root(node: Hashable) -> Hashable:
        while parents.setdefault(node, node) != node:
            parents[node] = parents[parents[node]]
            node = parents[node]
        return node

    for block in blocks:
        for node in (*signals_of(block.form), *block.topics):
            parents[root(node)] = root(block.order)
    members: dict[Hashable, list[RuleBlock]] = {}
    for block in blocks:
        members.setdefault(root(block.order), []).append(block)
    return [_cluster(group) for group in members.values()]


def _cluster(blocks: Sequence[RuleBlock]) -> Cluster:
    return Cluster(
        blocks=tuple(blocks),
        signals=tuple(sorted({signal for block in blocks for signal in signals_of(block.form)})),
        topics=tuple(sorted({topic for block in blocks for topic in block.topics})),
    )


State = Mapping[Signal, Value]


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """The intervals of one signal's possible values: their edges, and a value in each that is not empty."""

    signal: Signal
    edges: Sequence[Bound]
    samples: Mapping[int, Value]

    def intervals(self, region: SetOfValues) -> Iterator[int]:
        """The intervals that lie in ``region``, whose ends are edges; of texts those that it holds."""
        if isinstance(region, TextRegion):
            yield from (index for index, text in self.samples.items() if region.contains(text))
            return
        for low, high in region.pieces:
            start, end = bisect.bisect_left(self.edges, low), bisect.bisect_left(self.edges, high)
            yield from (index for index in range(start, end) if index in self.samples)


def axes_of(cluster: Cluster, domain: Domain) -> list[Axis]:
    """One axis for each signal of the cluster."""
    regions: dict[Signal, list[SetOfValues]] = {signal: [] for signal in cluster.signals}
    for block in cluster.blocks:
        for part in reads(block.form):
            regions[part.signal].append(part.region)
    return [_axis(signal, regions[signal], domain(signal)) for signal in cluster.signals]


def cell_count(axes: Sequence[Axis]) -> int:
    """How many cells the axes make."""
    return math.prod(len(axis.samples) for axis in axes)


def holding_together(
    cluster: Cluster, axes: Sequence[Axis], domain: Domain, effort: Effort
) -> dict[frozenset[int], State]:
    """Every set of blocks, by order, that hold together while no other does, with a state in which they do.

    Raises ``TooComplexError`` when ``effort`` is spent on the conditions' boxes.
    """
    boxes = [
        (block.order, box) for block in cluster.blocks for box in boxes_where([block.form], domain, effort)
    ]
    orders = [order for order, _ in boxes]
    masks: dict[int, dict[Signal, Value]] = {(1 << len(boxes)) - 1: {}}
    for axis in axes:
        along = _masks(axis, [box for _, box in boxes])
        # Cells with the same boxes so far go on as one.
        masks = {
            before & mask: {**state, axis.signal: axis.samples[index]}
            for before, state in reversed(masks.items())
            for index, mask in reversed(along.items())
        }
    found: dict[frozenset[int], State] = {}
    for mask, state in masks.items():
        found.setdefault(frozenset(orders[bit] for bit in _bits(mask)), state)
    return found


def _axis(signal: Signal, regions: Sequence[SetOfValues], domain: SetOfValues) -> Axis:
    if isinstance(domain, TextRegion):
        texts = {text for region in regions if isinstance(region, TextRegion) for text in region.texts}
        other = TextRegion(frozenset(texts), is_inverse=True).sample()
        return Axis(signal=signal, edges=(), samples=dict(enumerate([*sorted(texts), other])))
    cuts = {cut for region in regions if isinstance(region, Region) for cut in region.cuts}
    ends = {cut for piece in domain.pieces for cut in piece}
    whole = {cut for piece in Region.everything().pieces for cut in piece}
    edges = sorted(cuts | ends | whole)
    samples: dict[int, float] = {}
    for index in range(len(edges) - 1):
        values = Region.union_of([Region(((edges[index], edges[index + 1]),))]).intersection(domain)
        if not values.is_empty:
            samples[index] = values.sample()
    return Axis(signal=signal, edges=edges, samples=samples)


def _masks(axis: Axis, boxes: Sequence[Box]) -> dict[int, int]:
    """For each interval the bits of the boxes that do not exclude it."""
    masks = dict.fromkeys(axis.samples, 0)
    unbound = 0
    for bit, box in enumerate(boxes):
        region = box.get(axis.signal)
        if region is None:
            unbound |= 1 << bit
            continue
        for index in axis.intervals(region):
            masks[index] |= 1 << bit
    return {index: mask | unbound for index, mask in masks.items()}


def _bits(mask: int) -> Iterator[int]:
    while mask:
        lowest = mask & -mask
        yield lowest.bit_length() - 1
        mask ^= lowest


@dataclass(frozen=True, slots=True, kw_only=True)
class Loads:
    """KB for each message and the source's Hz, which Full passes on, by topic; ``profile`` has the bounds.

    ``floors_hz`` are the floors of the rules, which pass beside what bounds need.
    """

    size_kb: Mapping[str, float]
    source_hz: Mapping[str, float]
    floors_hz: Mapping[str, float] = field(default_factory=dict)
    profile: Profile = field(default_factory=Profile)

    def kb_per_s(self, topic: str, planned: PlannedRate) -> float:
        """The KB/s of ``topic`` as planned: at its rate, or at what its bounds need if that is less."""
        return self.size_kb[topic] * min(self.ceiling_hz(topic, planned.rate), self.needed_hz(topic, planned))

    def ceiling_hz(self, topic: str, rate: Rate) -> float:
        """The rate of ``topic``, that of the source for Full."""
        return self.source_hz[topic] if rate.is_full else rate.hz

    def needed_hz(self, topic: str, planned: PlannedRate) -> float:
        """The Hz that the bounds of ``topic`` and its heartbeat need; infinite where that is not known."""
        heartbeat_hz = self.floors_hz.get(topic, 0.0) or HEARTBEAT_HZ
        possible_hz = min(heartbeat_hz, self.source_hz.get(topic, math.inf))
        entry = self.profile.topic(topic)
        return max(entry.needed_hz(planned.within) / entry.streams, possible_hz)


def loads_of(rule_set: RuleSet, profile: Profile) -> Loads:
    """The loads of the relayed topics that ``profile`` knows."""
    entries = {topic: profile.topic(topic) for topic in rule_set.relayed}
    return Loads(
        size_kb={t: entry.kb_per_hz for t, entry in entries.items() if entry.kb_per_hz is not None},
        source_hz={t: entry.stream_hz for t, entry in entries.items() if entry.stream_hz is not None},
        floors_hz=rule_set.floors_hz,
        profile=profile,
    )


def missing_entries(rule_set: RuleSet, loads: Loads) -> list[tuple[str, str]]:
    """The topics whose load is not known, with the key that the profile lacks."""
    can_be_full = set(_full_topics(rule_set))
    missing = [(topic, "message_kb") for topic in rule_set.relayed if topic not in loads.size_kb]
    missing += [(t, "source_hz") for t in rule_set.relayed if t in can_be_full and t not in loads.source_hz]
    return missing


def _full_topics(rule_set: RuleSet) -> Iterable[str]:
    yield from (topic for topic in rule_set.relayed if topic not in rule_set.defaults)
    for rates in (rule_set.defaults, *(block.rates for block in rule_set.blocks)):
        yield from (topic for topic, rate in rates.items() if rate.is_full)


MAX_CELLS = 100_000
MAX_SITUATIONS = 100
_LOOKS = 5_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """The blocks that hold while no other does, a state in which they do, and what all topics then take."""

    blocks: tuple[RuleBlock, ...]
    state: Mapping[Signal, Value]
    kb_per_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Unproven:
    """A cluster that was not searched: too many ``cells``, or (``None``) too complex conditions."""

    blocks: tuple[RuleBlock, ...]
    cells: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class JointCheck:
    """The load of the rules in the worst case.

    ``worst`` is the situation of the greatest load, ``breaking`` those above the budget, worst first, and
    ``has_more`` says that the list was cut. What clusters in ``unproven`` set is left out of all of them.
    ``start_up_kb_per_s`` is the load while nothing is known, which no other state exceeds, unless a check
    reads a rate, bandwidth or age.
    """

    worst: Situation
    breaking: tuple[Situation, ...]
    has_more: bool
    unproven: tuple[Unproven, ...]
    start_up_kb_per_s: float


def check_together(
    rule_set: RuleSet,
    loads: Loads,
    budget_kb_per_s: float,
    domain: Domain,
    *,
    max_situations: int = MAX_SITUATIONS,
) -> JointCheck:
    """Every situation of ``rule_set``, a set over states, against the budget; all loads must be known."""
    meter = _Meter(rule_set, loads)
    unproven: list[Unproven] = []
    searched: list[list[_Choice]] = []
    effort = Effort(_LOOKS)
    for cluster in clusters_of(rule_set.blocks):
        found = _search(cluster, meter, domain, effort)
        if isinstance(found, Unproven):
            unproven.append(found)
        else:
            searched.append(found)
    situations = _worst_first(searched, meter.unconditional(), rule_set.blocks)
    worst = next(situations)
    over = itertools.takewhile(
        lambda one: not fits(one.kb_per_s, budget_kb_per_s), itertools.chain([worst], situations)
    )
    breaking = tuple(itertools.islice(over, max_situations + 1))
    return JointCheck(
        worst=worst,
        breaking=breaking[:max_situations],
        has_more=len(breaking) > max_situations,
        unproven=tuple(unproven),
        start_up_kb_per_s=meter.start_up_kb_per_s,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Choice:
    """One way in which the blocks of a cluster hold, and what the cluster's topics then take."""

    orders: tuple[int, ...]
    state: Mapping[Signal, Value]
    kb_per_s: float


def _search(cluster: Cluster, meter: _Meter, domain: Domain, effort: Effort) -> list[_Choice] | Unproven:
    """The ways in which the blocks of ``cluster`` hold, by falling load."""
    axes = axes_of(cluster, domain)
    cells = cell_count(axes)
    if cells > MAX_CELLS:
        return Unproven(blocks=cluster.blocks, cells=cells)
    try:
        found = holding_together(cluster, axes, domain, effort)
    except TooComplexError:
        return Unproven(blocks=cluster.blocks, cells=None)
    choices = [
        _Choice(orders=tuple(sorted(orders)), state=state, kb_per_s=meter.measure(cluster, state))
        for orders, state in found.items()
    ]
    return sorted(choices, key=lambda one: (-one.kb_per_s, one.orders))


class _Meter:
    """Reads the loads of states off the one evaluator."""

    def __init__(self, rule_set: RuleSet, loads: Loads) -> None:
        self._rule_set = rule_set
        self._loads = loads
        self._relayed = frozenset(rule_set.relayed)
        self._evaluator = Evaluator(rule_set)
        for signal in rule_set.signals:
            # Rates, bandwidths and ages are never unknown: they start at 0.
            if ArrivalProperty.of(signal) is not None:
                self._evaluator.set(signal, 0.0)
        self.start_up_kb_per_s = self._sum(rule_set.relayed)

    def measure(self, cluster: Cluster, state: Mapping[Signal, Value]) -> float:
        for signal, value in state.items():
            self._evaluator.set(signal, value)
        return self._sum(topic for topic in cluster.topics if topic in self._relayed)

    def unconditional(self) -> float:
        """The load of the topics that no block sets."""
        conditional = {topic for block in self._rule_set.blocks for topic in block.topics}
        return self._sum(topic for topic in self._rule_set.relayed if topic not in conditional)

    def _sum(self, topics: Iterable[str]) -> float:
        return math.fsum(self._loads.kb_per_s(topic, self._evaluator.request(topic)) for topic in topics)


def _worst_first(
    clusters: Sequence[Sequence[_Choice]], constant_kb_per_s: float, blocks: Sequence[RuleBlock]
) -> Iterator[Situation]:
    """One choice of each cluster, in all combinations, by falling load.

    Each combination but the first comes from one before it by taking the next choice of one cluster; taking
    it only of clusters from the last one changed on gives each once.
    """
    first = (0,) * len(clusters)
    heap = [(-_load(clusters, first, constant_kb_per_s), first, 0)]
    while heap:
        load, picks, changed = heapq.heappop(heap)
        chosen = [cluster[pick] for cluster, pick in zip(clusters, picks, strict=True)]
        orders = sorted(order for choice in chosen for order in choice.orders)
        yield Situation(
            blocks=tuple(blocks[order] for order in orders),
            state={signal: value for choice in chosen for signal, value in choice.state.items()},
            kb_per_s=-load,
        )
        for index in range(changed, len(clusters)):
            if picks[index] + 1 < len(clusters[index]):
                after = (*picks[:index], picks[index] + 1, *picks[index + 1 :])
                heapq.heappush(heap, (-_load(clusters, after, constant_kb_per_s), after, index))


def _load(clusters: Sequence[Sequence[_Choice]], picks: Sequence[int], constant_kb_per_s: float) -> float:
    loads = (cluster[pick].kb_per_s for cluster, pick in zip(clusters, picks, strict=True))
    return math.fsum([constant_kb_per_s, *loads])
