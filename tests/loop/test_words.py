# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules about texts, states and elements of arrays, driven in virtual time."""

from __future__ import annotations

import json
from types import SimpleNamespace

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.record import to_json

DOCKING = 'begin SetFrequency /scan 1 If (CheckValue /mode data = "docking") Then SetFrequency /scan 9 end'
BY_NAME = (
    "begin SetFrequency /scan 1"
    ' If (CheckValue /diagnostics status["lidar front"].level >= 2) Then SetFrequency /scan 9 end'
)
ANY = (
    "begin SetFrequency /scan 1"
    " If (CheckValue /diagnostics status[*].level >= 2) Then SetFrequency /scan 9 end"
)


def mode(data: object) -> object:
    return SimpleNamespace(data=data)


def diagnostics(**levels: int) -> object:
    status = [SimpleNamespace(name=name.replace("_", " "), level=bytes([of])) for name, of in levels.items()]
    return SimpleNamespace(status=status)


def test_a_text_of_a_mode_sets_a_rate_and_stands_in_the_decision() -> None:
    driver = LoopDriver(DOCKING, Profile(settle_s=0.0))
    assert driver.rates() == {"/scan": 9.0}
    driver.send("/mode", SECOND, message=mode("driving"))
    driver.send("/mode", 2 * SECOND, message=mode("docking"))
    assert [(one.planned.rate.hz, dict(one.values)) for one in driver.decisions] == [
        (9.0, {"/mode data": None}),
        (1.0, {}),
        (9.0, {"/mode data": "docking"}),
    ]
    assert json.loads(json.dumps(to_json(driver.decisions[-1])))["values"] == {"/mode data": "docking"}


def test_a_text_lasts_while_there_is_a_publisher() -> None:
    driver = LoopDriver(DOCKING, Profile(settle_s=0.0))
    for number in range(5):
        driver.send("/mode", number * SECOND, message=mode("driving"))
    driver.wait_until(3600 * SECOND)
    assert driver.rates() == {"/scan": 1.0}
    driver.source("/mode", publishers=0)
    assert driver.rates() == {"/scan": 9.0}
    driver.source("/mode", publishers=1)
    assert driver.rates() == {"/scan": 9.0}
    driver.send("/mode", 3601 * SECOND, message=mode("driving"))
    assert driver.rates() == {"/scan": 1.0}


def test_a_text_turns_stale_where_the_profile_says_after_how_long() -> None:
    profile = Profile(settle_s=0.0, topics={"/mode": TopicProfile(stale_after_s=3.0)})
    driver = LoopDriver(DOCKING, profile)
    driver.send("/mode", SECOND, message=mode("driving"))
    driver.wait_until(4 * SECOND)
    assert driver.rates() == {"/scan": 1.0}
    driver.wait_until(4 * SECOND + 1)
    assert driver.rates() == {"/scan": 9.0}


def test_a_number_turns_stale_as_before_beside_a_state_that_does_not() -> None:
    rules = (
        "begin SetFrequency /a 1 SetFrequency /b 1"
        " If (CheckValue /stop data = true) Then SetFrequency /a 9"
        " If (CheckValue /stop data = 1) Then SetFrequency /b 9 end"
    )
    driver = LoopDriver(rules, Profile(settle_s=0.0))
    for number in range(5):
        driver.send("/stop", number * SECOND, message=mode(False))
    assert driver.rates() == {"/a": 1.0, "/b": 1.0}
    driver.wait_until(10 * SECOND)
    assert driver.rates() == {"/a": 1.0, "/b": 9.0}
    driver.send("/stop", 11 * SECOND, message=mode(True))
    assert driver.rates() == {"/a": 9.0, "/b": 9.0}


def test_what_is_no_text_is_unknown_and_a_huge_one_is_another_and_is_cut() -> None:
    driver = LoopDriver(DOCKING.replace("= ", "!= "), Profile(settle_s=0.0))
    driver.send("/mode", SECOND, message=mode("docking"))
    assert driver.rates() == {"/scan": 1.0}
    driver.send("/mode", 2 * SECOND, message=mode(7))
    assert driver.decisions[-1].planned.reason.value == "unknown"
    driver.send("/mode", 3 * SECOND, message=mode("\x1b]0;$(reboot)" * 800_000))
    assert driver.decisions[-1].planned.reason.value == "block"
    (value,) = driver.decisions[-1].values.values()
    assert isinstance(value, str)
    assert (len(value), value[-1]) == (1001, "…")


def test_an_element_keeps_its_value_while_other_nodes_publish_until_it_is_stale_itself() -> None:
    driver = LoopDriver(BY_NAME, Profile(settle_s=0.0))
    driver.send("/diagnostics", 0, message=diagnostics(battery=0))
    assert driver.rates() == {"/scan": 9.0}
    for number in range(1, 6):
        driver.send("/diagnostics", number * SECOND, message=diagnostics(lidar_front=0))
        driver.send("/diagnostics", number * SECOND + SECOND // 2, message=diagnostics(battery=2))
        assert driver.rates() == {"/scan": 1.0}
    for number in range(6, 12):
        driver.send("/diagnostics", number * SECOND, message=diagnostics(battery=0))
    # Five of its own periods after 5 s, whatever else comes.
    assert driver.decisions[-1].t_s == 10.000000001
    assert driver.rates() == {"/scan": 9.0}
    driver.source("/diagnostics", publishers=0)
    driver.source("/diagnostics", publishers=1)
    driver.send("/diagnostics", 12 * SECOND, message=diagnostics(battery=0))
    assert dict(driver.loop.knowledge.values_of(0, 12 * SECOND)) == {
        '/diagnostics status["lidar front"].level': None
    }


def test_any_element_is_enough_and_the_decision_shows_the_one() -> None:
    driver = LoopDriver(ANY, Profile(settle_s=0.0))
    driver.send("/diagnostics", SECOND, message=diagnostics())
    assert driver.rates() == {"/scan": 1.0}
    driver.send("/diagnostics", 2 * SECOND, message=diagnostics(a=0, b=1, c=3, d=2))
    assert driver.rates() == {"/scan": 9.0}
    assert dict(driver.decisions[-1].values) == {"/diagnostics status[*].level": 3.0}
    driver.send("/diagnostics", 3 * SECOND, message=diagnostics(a=0, b=1))
    assert driver.rates() == {"/scan": 1.0}


def test_a_reload_keeps_texts_elements_and_what_all_elements_were() -> None:
    driver = LoopDriver(ANY, Profile(settle_s=0.0))
    driver.send("/diagnostics", SECOND, message=diagnostics(a=0, b=1))
    driver.reload(ANY.replace(">= 2", ">= 1"), Profile(settle_s=0.0))
    assert driver.rates() == {"/scan": 9.0}
    driver.reload(ANY.replace(">= 2", ">= 2.5"), Profile(settle_s=0.0))
    assert driver.rates() == {"/scan": 1.0}


def test_an_unresolved_constant_is_unknown_whatever_comes() -> None:
    rules = "begin SetFrequency /scan 1 If (CheckValue /mode data != DOCKING) Then SetFrequency /scan 9 end"
    driver = LoopDriver(rules, Profile(settle_s=0.0))
    driver.send("/mode", SECOND, message=mode(1))
    assert [one.planned.reason.value for one in driver.decisions] == ["unknown"]
    assert not driver.loop.knowledge.reads("/mode")


def test_a_text_and_a_number_of_one_property_are_read_beside_each_other() -> None:
    rules = (
        "begin SetFrequency /a 1 SetFrequency /b 1"
        ' If (CheckValue /mode data = "1") Then SetFrequency /a 9'
        " If (CheckValue /mode data = 1) Then SetFrequency /b 9"
        ' If (CheckValue /mode rate = "fast") Then SetFrequency /c 9 end'
    )
    driver = LoopDriver(rules, Profile(settle_s=0.0))
    driver.send("/mode", SECOND, message=mode("1"))
    assert driver.rates() == {"/a": 9.0, "/b": 9.0, "/c": None}
    driver.send("/mode", 2 * SECOND, message=mode(1))
    driver.send("/mode", 3 * SECOND, message=mode(0))
    assert driver.rates() == {"/a": 9.0, "/b": 1.0, "/c": None}
