# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Large rules checked in a process of their own.

Checking some thousand rules takes seconds of the interpreter and memory that it does not give back. Both are
the other process's, so messages are relayed meanwhile as if nothing happened.
"""

from __future__ import annotations

import gc
import json
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from multiprocessing.connection import Connection, Pipe

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.language.normal_form import Resolve
from smarttestudo.robot.live_rules import LiveRules, UncheckedRules

_POLL_S = 0.2
_NICENESS = 10
_CHILD = "import json, sys; sys.path[:] = json.loads(sys.argv[2]); "
_CHILD += "from smarttestudo.robot.rule_checking import serve; serve(int(sys.argv[1]))"


def check_elsewhere(rules: UncheckedRules, resolve: Resolve, is_ended: Callable[[], bool]) -> LiveRules:
    """Check ``rules`` in a process of their own, or here where none can be had. Raises ``TestudoError``.

    Nobody waits for the process once the run ``is_ended``.
    """
    ours, theirs = Pipe()
    with ours:
        with theirs:
            command = [sys.executable, "-c", _CHILD, str(theirs.fileno()), json.dumps(sys.path)]
            try:
                process = subprocess.Popen(  # noqa: S603 - this package
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    pass_fds=(theirs.fileno(),),
                    start_new_session=True,
                )
            except OSError:
                return rules.checked(resolve)
        try:
            answer = _answer(ours, rules, resolve, is_ended)
        except (EOFError, OSError):
            return rules.checked(resolve)
        finally:
            process.kill()
            process.wait()
    if isinstance(answer, Exception):
        raise answer
    return replace(answer, texts=rules.texts, profile_text=rules.profile_text)


def _answer(
    pipe: Connection, rules: UncheckedRules, resolve: Resolve, is_ended: Callable[[], bool]
) -> LiveRules | Exception:
    pipe.send(rules)
    while True:
        while not pipe.poll(_POLL_S):
            if is_ended():
                return RuleFileError("the rules were not checked to the end")
        with unnoticed():
            answer = pickle.loads(pipe.recv_bytes())  # noqa: S301 - from a process of ours
        if not isinstance(answer, str):
            return answer  # type: ignore[no-any-return]
        try:
            pipe.send(resolve(answer))
        except Exception as error:  # noqa: BLE001 - the other side raises it
            pipe.send(error)


def serve(descriptor: int) -> None:
    """Check the rules that come over the pipe; what is sent back is a name to resolve, or the outcome."""
    with suppress(OSError):
        os.nice(_NICENESS)
    gc.disable()
    with Connection(descriptor) as pipe:

        def resolve(topic: str) -> str:
            pipe.send(topic)
            full = pipe.recv()
            if isinstance(full, Exception):
                raise full
            return str(full)

        try:
            rules: UncheckedRules = pipe.recv()
            pipe.send(replace(rules.checked(resolve), texts={}, profile_text=None))
        except Exception as error:  # noqa: BLE001 - the other side raises it
            pipe.send(error)


_SWITCH_INTERVAL_S = 0.000_5


@contextmanager
def unnoticed() -> Iterator[None]:
    """Let this thread make many objects while others go on.

    They get the interpreter soon when they need it. Nothing looks for cycles meanwhile, nor later among what
    was made: a walk over all rules would hold up every message.
    """
    interval_s = sys.getswitchinterval()
    gc.disable()
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    try:
        yield
    finally:
        sys.setswitchinterval(interval_s)
        gc.freeze()
        gc.enable()
