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
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from io import BytesIO
from multiprocessing.connection import Connection, Pipe

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.rule_set import RuleBlock
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.low_priority import low_priority

_POLL_S = 0.2
_NICENESS = 10
_CHILD = "import json, sys; sys.path[:] = json.loads(sys.argv[2]); "
_CHILD += "from smarttestudo.robot.rule_checking import serve; serve(int(sys.argv[1]))"


CheckRules = Callable[[Resolve], LiveRules]
"""Checks rules; it travels to another process, with all that it needs but the names of topics."""


def check_elsewhere(check: CheckRules, resolve: Resolve, is_ended: Callable[[], bool]) -> LiveRules:
    """Call ``check`` in a process of its own, or here where none can be had. Raises ``TestudoError``.

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
                return check(resolve)
        try:
            answer = _answer(ours, check, resolve, is_ended)
        except (EOFError, OSError):
            return check(resolve)
        finally:
            process.kill()
            process.wait()
    if isinstance(answer, Exception):
        raise answer
    return answer


def _answer(
    pipe: Connection, check: CheckRules, resolve: Resolve, is_ended: Callable[[], bool]
) -> LiveRules | Exception:
    pipe.send(check)
    incoming = _Incoming()
    blocks: list[RuleBlock] = []
    while True:
        while not pipe.poll(_POLL_S):
            if is_ended():
                return RuleFileError("the rules were not checked to the end")
        with low_priority() as yield_turn:
            while True:
                answer = incoming.read(pipe.recv_bytes())
                if not isinstance(answer, _Piece):
                    break
                blocks += answer.blocks
                yield_turn()
        if isinstance(answer, LiveRules):
            return _whole(answer, blocks)
        if not isinstance(answer, str):
            return answer
        try:
            pipe.send(resolve(answer))
        except Exception as error:  # noqa: BLE001 - the other side raises it
            pipe.send(error)


def _whole(rules: LiveRules, blocks: Sequence[RuleBlock]) -> LiveRules:
    """``rules`` with their blocks, whose topics and signals they know already."""
    object.__setattr__(rules.rule_set, "blocks", tuple(blocks))
    return rules


_BLOCKS_A_PIECE = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class _Piece:
    """Some blocks of the rules, so few that reading them takes no time to speak of."""

    blocks: tuple[RuleBlock, ...]


class _Outgoing:
    """Objects as bytes; what one of them shares with those before is not said again."""

    def __init__(self) -> None:
        self._stream = BytesIO()
        self._pickler = pickle.Pickler(self._stream, protocol=pickle.HIGHEST_PROTOCOL)

    def write(self, value: object) -> bytes:
        """The bytes of the next object."""
        self._stream.seek(0)
        self._stream.truncate()
        self._pickler.dump(value)
        return self._stream.getvalue()


class _Incoming:
    """Bytes of ``_Outgoing``, in order, as objects."""

    def __init__(self) -> None:
        self._stream = BytesIO()
        self._unpickler = pickle.Unpickler(self._stream)  # noqa: S301 - from a process of ours

    def read(self, data: bytes) -> str | _Piece | LiveRules | Exception:
        """The next object."""
        self._stream.seek(0)
        self._stream.truncate()
        self._stream.write(data)
        self._stream.seek(0)
        return self._unpickler.load()  # type: ignore[no-any-return]


def serve(descriptor: int) -> None:
    """Check the rules that come over the pipe.

    Names to resolve are sent back, then pieces of the rules, at last the outcome.
    """
    with suppress(OSError):
        os.nice(_NICENESS)
    gc.disable()
    outgoing = _Outgoing()
    with Connection(descriptor) as pipe:

        def send(value: object) -> None:
            pipe.send_bytes(outgoing.write(value))

        def resolve(topic: str) -> str:
            send(topic)
            full = pipe.recv()
            if isinstance(full, Exception):
                raise full
            return str(full)

        try:
            check: CheckRules = pipe.recv()
            rules = check(resolve)
            # What compiles them anew is large; they are checked anew instead.
            rules = replace(rules, rule_set=replace(rules.rule_set, anew=None))
            rule_set = rules.rule_set
            for start in range(0, len(rule_set.blocks), _BLOCKS_A_PIECE):
                send(_Piece(blocks=rule_set.blocks[start : start + _BLOCKS_A_PIECE]))
            object.__setattr__(rule_set, "blocks", ())
            send(rules)
        except Exception as error:  # noqa: BLE001 - the other side raises it
            send(error)
