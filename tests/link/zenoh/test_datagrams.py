# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sealed datagrams beside a link on this machine: used where they come through, and closed to others."""

from __future__ import annotations

import random
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.zenoh.ends import MAP, ODOM, Reader, free_endpoint, refuse_warning, until
from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.datagrams import (
    CONNECTION_BYTES,
    FORGOTTEN_AFTER_NS,
    KEY_BYTES,
    WINDOW,
    PingLosses,
    ReplayWindow,
)
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.datagrams import Datagrams, Seal
from smarttestudo.link.zenoh.operator_end import OperatorEnd
from smarttestudo.link.zenoh.robot_end import RobotEnd
from smarttestudo.link.zenoh.security import LinkOptions, has_datagrams


def seals() -> tuple[Seal, Seal]:
    """The robot's end and the operator's end of a connection."""
    generator = random.Random(1)
    connection, key = generator.randbytes(CONNECTION_BYTES), generator.randbytes(KEY_BYTES)
    return Seal(connection, key, is_robot=True), Seal(connection, key, is_robot=False)


@given(st.lists(st.binary(max_size=1_168), min_size=1, max_size=20), st.randoms(use_true_random=False))
def test_what_is_sealed_opens_once_at_the_other_end_in_any_order(
    texts: list[bytes], order: random.Random
) -> None:
    robot, operator = seals()
    sent = [robot.seal(text) for text in texts]
    assert all(len(datagram) == len(text) + 32 for datagram, text in zip(sent, texts, strict=True))
    twice = [*enumerate(sent), *enumerate(sent)]
    order.shuffle(twice)
    opened = [(place, found[0]) for place, datagram in twice if (found := operator.open(datagram))]
    assert sorted(opened) == list(enumerate(texts))


@given(st.binary(min_size=1, max_size=200), st.data())
def test_what_was_changed_cut_or_sent_back_opens_nowhere(text: bytes, data: st.DataObject) -> None:
    robot, operator = seals()
    datagram = robot.seal(text)
    at = data.draw(st.integers(0, len(datagram) - 1))
    changed = bytes([*datagram[:at], datagram[at] ^ data.draw(st.integers(1, 255)), *datagram[at + 1 :]])
    assert operator.open(changed) is None
    assert operator.open(datagram[: data.draw(st.integers(17, len(datagram) - 1))]) is None
    assert robot.open(datagram) is None
    assert text not in datagram or len(text) < 4
    other = Seal(datagram[:CONNECTION_BYTES], bytes(KEY_BYTES), is_robot=False)
    assert other.open(datagram) is None
    assert operator.open(datagram) == (text, True)


@given(st.lists(st.integers(0, 3 * WINDOW), max_size=200))
def test_each_number_is_taken_once_and_none_that_is_too_old_to_know(numbers: list[int]) -> None:
    window, seen = ReplayWindow(), set[int]()
    for number in numbers:
        is_known = number in seen or number <= max(seen, default=0) - WINDOW
        assert window.take(number) is not is_known
        seen.add(number)


def test_pings_that_are_lost_count_but_for_those_of_an_outage() -> None:
    pings, counted = PingLosses(), list[tuple[int, int]]()
    for at_ns, is_answered in enumerate([True, False, True, False, False, True, *(3 * [False]), True, True]):
        pings.ask(at_ns)
        if is_answered:
            counted.append(pings.answer(at_ns))
    assert counted == [(1, 0), (2, 1), (3, 2), (0, 0), (1, 0)]
    assert pings.answer(10) == (0, 0)


def test_between_programs_of_one_machine_datagrams_go_only_if_a_port_is_given() -> None:
    here, there = ("tcp/127.0.0.1:7447",), ("tls/192.168.1.5:7447",)
    assert not has_datagrams(LinkOptions(connect=here))
    assert has_datagrams(LinkOptions(connect=here, datagrams_port=7450))
    assert has_datagrams(LinkOptions(connect=there))
    assert not has_datagrams(LinkOptions(connect=there, has_datagrams=False))
    # Zenoh has that UDP port itself.
    assert not has_datagrams(LinkOptions(connect=("quic/192.168.1.5:7447",)))
    assert not has_datagrams(LinkOptions(listen=("unixsock-stream/link",), datagrams_port=7450))


@contextmanager
def both_ends(
    *, robot_listens: bool = False, robot_has: bool = True, operator_has: bool = True
) -> Iterator[tuple[RobotEnd, OperatorEnd]]:
    endpoint = free_endpoint()
    port = int(endpoint.rpartition(":")[2])
    listening = LinkOptions(listen=(endpoint,), datagrams_port=port)
    # The other one sends from another port of this machine.
    connecting = LinkOptions(connect=(endpoint,), datagrams_port=port + 20_000)
    of_robot, of_operator = (listening, connecting) if robot_listens else (connecting, listening)
    with ExitStack() as opened:
        operator = replace(of_operator, has_datagrams=operator_has)
        robot = replace(of_robot, has_datagrams=robot_has, needs_datagrams=robot_has)
        if robot_listens:
            first = opened.enter_context(open_robot_end("r1", robot, refuse_warning))
            yield first, opened.enter_context(open_operator_end(operator, refuse_warning))
        else:
            end = opened.enter_context(open_operator_end(operator, refuse_warning))
            yield opened.enter_context(open_robot_end("r1", robot, refuse_warning)), end


@pytest.mark.contract
@pytest.mark.parametrize("robot_listens", [False, True])
def test_what_is_relayed_goes_as_datagrams_whoever_listens(*, robot_listens: bool) -> None:
    with both_ends(robot_listens=robot_listens) as (robot, operator):
        reader, latched, publisher = Reader(operator), robot.advertise(MAP), robot.advertise(ODOM)
        latched.publish(b"map" * 1_000)
        # On a link as fast as this one they may give way soon.
        until(lambda: robot.state.lost_percent is not None, reader.read)
        image = random.Random(3).randbytes(60_000)
        until(lambda: image in reader.payloads(), lambda: publisher.publish(image))
        assert reader.payloads("/map") == [b"map" * 1_000]


@pytest.mark.full
@pytest.mark.parametrize(("robot_has", "operator_has"), [(False, True), (True, False)])
def test_an_end_without_datagrams_has_the_reliable_link(*, robot_has: bool, operator_has: bool) -> None:
    with both_ends(robot_has=robot_has, operator_has=operator_has) as (robot, operator):
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        until(lambda: bool(reader.payloads()), lambda: publisher.publish(b"one"))
        assert not robot.state.by_datagrams


@pytest.mark.full
def test_a_stranger_at_the_port_gets_nothing_and_delivers_nothing() -> None:
    with both_ends() as (robot, operator), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        until(lambda: robot.state.by_datagrams, reader.read)
        assert operator._datagrams is not None
        stranger.settimeout(0.5)
        generator = random.Random(4)
        for size_bytes in (0, 1, 15, 16, 17, 60, 1_200, 9_000):
            stranger.sendto(generator.randbytes(size_bytes), ("127.0.0.1", operator._datagrams.port or 0))
        with pytest.raises(TimeoutError):
            stranger.recv(100)
        until(lambda: b"one" in reader.payloads(), lambda: publisher.publish(b"one"))
        assert {*reader.payloads()} == {b"one"}
        datagrams = operator._datagrams
        until(lambda: datagrams.refused >= 5)


@pytest.mark.full
def test_only_what_has_the_key_of_the_connection_is_delivered_once_and_followed() -> None:
    delivered = list[bytes]()
    options = LinkOptions(listen=("tcp/127.0.0.1:1",), datagrams_port=_free_udp_port())
    ours = Datagrams(
        options,
        time.monotonic_ns,
        lambda _peer, data: delivered.append(data),
        lambda _reached: None,
        refuse_warning,
        is_robot=False,
    )
    with closing(ours), closing(_udp()) as robot, closing(_udp()) as stranger, closing(_udp()) as moved:
        assert ours.port is not None
        there = ("127.0.0.1", ours.port)
        ours.add("robot", b"c" * CONNECTION_BYTES, b"k" * KEY_BYTES, None)
        ours.add("other", b"d" * CONNECTION_BYTES, b"l" * KEY_BYTES, None)
        peer = ours.peer("robot")
        assert peer is not None
        seal = Seal(b"c" * CONNECTION_BYTES, b"k" * KEY_BYTES, is_robot=True)
        of_another = Seal(b"c" * CONNECTION_BYTES, b"l" * KEY_BYTES, is_robot=True)
        first, second, third = (seal.seal(b"%d of the robot" % number) for number in range(3))
        robot.sendto(second, there)
        until(lambda: len(delivered) == 1)
        strange = (
            second,
            of_another.seal(b"with the key of another session"),
            peer.seal.seal(b"ours, sent back"),
            third[:-1],
            third + bytes(1_000),
            third + bytes(9_000),
            bytes([third[0] ^ 1, *third[1:]]),
            first[:CONNECTION_BYTES] + third[CONNECTION_BYTES : CONNECTION_BYTES + 8] + first[16:],
        )
        for datagram in strange:
            stranger.sendto(datagram, there)
        until(lambda: ours.refused == len(strange))
        assert peer.address == robot.getsockname()
        moved.sendto(third, there)
        # What was overtaken is delivered, and says nothing of where the robot is now.
        robot.sendto(first, there)
        until(lambda: len(delivered) == 3)
        assert peer.address == moved.getsockname()
    assert sorted(delivered) == [b"%d of the robot" % number for number in range(3)]


@pytest.mark.full
@pytest.mark.parametrize("robot_listens", [False, True])
def test_where_another_program_has_the_udp_port_the_reliable_link_carries_all(*, robot_listens: bool) -> None:
    with ExitStack() as opened:
        # Others reach it, too: so it has datagrams though no port is given for them.
        endpoint = free_endpoint(host="0.0.0.0")
        port = int(endpoint.rpartition(":")[2])
        opened.enter_context(closing(_udp(port)))
        listening = LinkOptions(listen=(endpoint,), insecure=True)
        connecting = LinkOptions(connect=(f"tcp/127.0.0.1:{port}",), datagrams_port=_free_udp_port())
        warnings = list[str]()
        if robot_listens:
            robot = opened.enter_context(open_robot_end("r1", listening, warnings.append))
            operator = opened.enter_context(open_operator_end(connecting, refuse_warning))
        else:
            operator = opened.enter_context(open_operator_end(listening, warnings.append))
            robot = opened.enter_context(open_robot_end("r1", connecting, refuse_warning))
        reader, publisher = Reader(operator), robot.advertise(ODOM)
        until(lambda: bool(reader.payloads()), lambda: publisher.publish(b"one"))
        assert not robot.state.by_datagrams
        assert [text for text in warnings if not text.startswith("--insecure")] == [
            f"udp 0.0.0.0:{port}: datagrams cannot be sent: Address already in use: what is relayed goes "
            "over the reliable link; give another port with --datagrams PORT, or --datagrams off"
        ]


@pytest.mark.full
def test_datagrams_that_are_asked_for_need_their_port() -> None:
    with closing(_udp()) as holder:
        port = holder.getsockname()[1]
        options = LinkOptions(listen=(free_endpoint(),), datagrams_port=port, needs_datagrams=True)
        ends = (open_operator_end(options, refuse_warning), open_robot_end("r1", options, refuse_warning))
        for end in ends:
            with (
                pytest.raises(LinkError, match=rf"^udp 127.0.0.1:{port}: error: .*in use; give another"),
                end,
            ):
                raise AssertionError


@pytest.mark.full
def test_a_robots_end_forgets_who_answers_nothing_for_a_minute() -> None:
    now_ns = 0
    options = LinkOptions(connect=("tcp/127.0.0.1:1",), datagrams_port=_free_udp_port())
    ours = Datagrams(
        options,
        lambda: now_ns,
        lambda _peer, _data: None,
        lambda _reached: None,
        lambda text: None,
        is_robot=True,
    )
    with closing(ours):
        ours.offer("operator", 1, _free_udp_port())
        now_ns = FORGOTTEN_AFTER_NS
        assert ours.peer("operator") is not None
        now_ns += 1
        until(lambda: ours.peer("operator") is None)


def _udp(port: int = 0) -> socket.socket:
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    opened.bind(("127.0.0.1", port))
    return opened


def _free_udp_port() -> int:
    with closing(_udp()) as probe:
        port: int = probe.getsockname()[1]
        return port
