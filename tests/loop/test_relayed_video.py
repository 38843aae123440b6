# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A relay passes coded video by whole groups, whatever type carries it and whatever else is asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest

from loop.loop_driver import SECOND, LoopDriver
from pacing.bitstreams import IDR, NON_IDR_P, PPS, SPS, compressed_image, compressed_video, ffmpeg_packet, nal
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.pacing.sample import WhenSlow

RULES = "begin SetFrequency /v 10 SetFrequency /image 10 SetFrequency /info 10 end"
KEY, DIFFERENCE = nal(SPS, PPS, IDR), nal(NON_IDR_P)


def video(at_ns: int, *, is_key: bool) -> bytes:
    return compressed_video(KEY if is_key else DIFFERENCE, "h264", stamp_ns=at_ns)


def image(at_ns: int, *, is_key: bool) -> bytes:
    return compressed_image(KEY if is_key else DIFFERENCE, "h264", stamp_ns=at_ns)


def packet(at_ns: int, *, is_key: bool) -> bytes:
    return ffmpeg_packet(b"\xff", "h264", flags=is_key, stamp_ns=at_ns)


MAKERS: dict[str, Callable[..., bytes]] = {
    "foxglove_msgs/msg/CompressedVideo": video,
    "sensor_msgs/msg/CompressedImage": image,
    "ffmpeg_image_transport_msgs/msg/FFMPEGPacket": packet,
}


def times(count: int = 300) -> list[int]:
    return [SECOND + number * SECOND // 30 for number in range(count)]


def send_video(driver: LoopDriver, type_name: str, numbers: Sequence[int] = range(300)) -> None:
    for number in numbers:
        at_ns = times()[number]
        driver.send("/v", at_ns, MAKERS[type_name](at_ns, is_key=number % 30 == 0))


def shown(driver: LoopDriver) -> list[int]:
    """How many frames of each group were relayed, all from its beginning on."""
    passed = set(driver.stamps_of("/v"))
    groups = [[at_ns in passed for at_ns in times()[start : start + 30]] for start in range(0, 300, 30)]
    assert all(group == sorted(group, reverse=True) for group in groups)
    return [sum(group) for group in groups]


@pytest.mark.parametrize("type_name", MAKERS)
@pytest.mark.parametrize("when_slow", list(WhenSlow))
def test_of_each_second_the_first_third_passes(type_name: str, when_slow: WhenSlow) -> None:
    driver = LoopDriver(RULES, when_slow=when_slow, types={"/v": type_name})
    send_video(driver, type_name)
    assert shown(driver)[3:] == [10] * 7
    assert not any(one.repeated for one in driver.relayed)


@pytest.mark.parametrize("type_name", MAKERS)
def test_it_may_neither_be_skipped_but_while_off_nor_relayed_without_python(type_name: str) -> None:
    driver = LoopDriver(RULES, types={"/v": type_name})
    send_video(driver, type_name, range(1))
    assert not driver.loop.may_leave("/v")
    assert not driver.loop.may_skip("/v")
    driver.reload("begin SetFrequency /v Off end")
    driver.wait_until(3 * SECOND)
    assert driver.loop.may_skip("/v")
    assert not driver.loop.may_leave("/v")


def test_images_among_video_of_one_topic_stand_by_themselves() -> None:
    driver = LoopDriver(RULES, types={"/v": "sensor_msgs/msg/CompressedImage"})
    for at_ns in times():
        driver.send("/v", at_ns, compressed_image(b"\xff\xd8", "rgb8; jpeg compressed bgr8"))
    assert driver.loop.may_leave("/v")
    assert abs(len(driver.stamps_of("/v")) - 100) <= 1


@pytest.mark.parametrize("type_name", MAKERS)
def test_it_follows_no_other_topic(type_name: str) -> None:
    paced = {"/v": TopicProfile(paced_with="/image"), "/info": TopicProfile(paced_with="/image")}
    driver = LoopDriver(RULES, Profile(topics=paced), types={"/v": type_name})
    for number, at_ns in enumerate(times()):
        stamped = compressed_image(b"", "jpeg", stamp_ns=at_ns)
        driver.send("/image", at_ns, stamped)
        driver.send("/info", at_ns, stamped)
        send_video(driver, type_name, [number])
    assert shown(driver)[3:] == [10] * 7
    assert driver.stamps_of("/info") == driver.stamps_of("/image")


@pytest.mark.parametrize("type_name", MAKERS)
def test_others_follow_it(type_name: str) -> None:
    profile = Profile(topics={"/info": TopicProfile(paced_with="/v")})
    driver = LoopDriver(RULES, profile, types={"/v": type_name})
    for number, at_ns in enumerate(times()):
        driver.send("/info", at_ns, compressed_image(b"", "jpeg", stamp_ns=at_ns))
        send_video(driver, type_name, [number])
    assert shown(driver)[3:] == [10] * 7
    assert driver.stamps_of("/info") == driver.stamps_of("/v")


def test_after_nobody_listened_it_goes_on_with_a_key_frame() -> None:
    type_name = "foxglove_msgs/msg/CompressedVideo"
    driver = LoopDriver("begin SetFrequency /v Full end", types={"/v": type_name})
    send_video(driver, type_name, range(95))
    driver.listeners("/v", are_there=False)
    driver.listeners("/v", are_there=True)
    send_video(driver, type_name, range(100, 300))
    passed = set(driver.stamps_of("/v"))
    assert [at_ns in passed for at_ns in times()] == [not 95 <= number < 120 for number in range(300)]


def test_another_type_on_the_topic_is_paced_as_that_type_is() -> None:
    driver = LoopDriver(RULES, types={"/v": "foxglove_msgs/msg/CompressedVideo"})
    send_video(driver, "foxglove_msgs/msg/CompressedVideo", range(50))
    driver.source("/v", type_name="std_msgs/msg/String")
    before = len(driver.stamps_of("/v"))
    for at_ns in times()[50:]:
        driver.send("/v", at_ns, b"\0\1\0\0\1\0\0\0\0")
    assert abs(len(driver.stamps_of("/v")) - before - 250 / 3) <= 2
    assert driver.loop.may_leave("/v")


def test_the_rate_may_change_at_any_time() -> None:
    type_name = "sensor_msgs/msg/CompressedImage"
    driver = LoopDriver(RULES, types={"/v": type_name})
    send_video(driver, type_name, range(135))
    driver.reload("begin SetFrequency /v Full end")
    send_video(driver, type_name, range(135, 225))
    driver.reload("begin SetFrequency /v 1 end")
    send_video(driver, type_name, range(225, 300))
    assert shown(driver)[4:7] == [10, 30, 30]
    assert max(shown(driver)[8:]) <= 2
