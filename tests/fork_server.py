# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A process that has imported SmartTestudo and forks once for each request; ``forked_python.py`` asks it.

usage: fork_server.py FD
Each message on the Unix socket FD is JSON, ``arguments`` as Python's own, ``environment`` and ``folder``. It
comes with four files: the new process's standard streams, and the pipe on which the server says the number of
the process and, once that has ended, its exit code. The server ends with the socket.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import io
import json
import os
import pkgutil
import runpy
import selectors
import signal
import socket
import sys
import types
from contextlib import suppress
from pathlib import Path
from typing import Any

import smarttestudo

LONGEST_REQUEST_BYTES = 200_000
# The loader and rclpy look for libraries where this process began to, whatever a request's environment says.
OF_LIBRARIES = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH")
# What servers and nodes import while they start; of ROS only what does not import rclpy.
IMPORTED_LATE = (
    "anyio._backends._asyncio",
    "uvicorn.lifespan.on",
    "uvicorn.loops.asyncio",
    "uvicorn.protocols.http.h11_impl",
    "uvicorn.protocols.websockets.websockets_sansio_impl",
    "diagnostic_msgs.msg",
    "geometry_msgs.msg",
    "nav_msgs.msg",
    "rcl_interfaces.srv",
    "rosgraph_msgs.msg",
    "rosidl_generator_py",
    "sensor_msgs.msg",
    "std_srvs.srv",
    "type_description_interfaces.srv",
)
RESET = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGCHLD)


def import_everything() -> None:
    """Import all of SmartTestudo but what imports rclpy, which starts threads, and threads are not forked."""
    ours = [module.name for module in pkgutil.walk_packages(smarttestudo.__path__, "smarttestudo.")]
    of_ros = "smarttestudo.robot.ros."
    for name in (*ours, *IMPORTED_LATE):
        if not name.startswith(of_ros) and not name.endswith("__main__"):
            # An extra may not be installed; who needs it says so.
            with suppress(ImportError):
                importlib.import_module(name)


def next_request(requests: socket.socket) -> dict[str, Any]:
    """Fork for each request; returns in the new process only, with its streams in place."""
    waiting = selectors.DefaultSelector()
    waiting.register(requests, selectors.EVENT_READ)
    while True:
        for key, _ in waiting.select():
            if key.fileobj is not requests:
                report_exit(key.fd, *key.data)
                waiting.unregister(key.fd)
                os.close(key.fd)
                continue
            data, files, _, _ = socket.recv_fds(requests, LONGEST_REQUEST_BYTES, 4)
            if not data:
                sys.exit()
            number = os.fork()
            if not number:
                waiting.close()
                requests.close()
                os.close(files[3])
                take_streams(files[:3])
                request: dict[str, Any] = json.loads(data)
                return request
            for file in files[:3]:
                os.close(file)
            os.write(files[3], f"{number}\n".encode())
            waiting.register(os.pidfd_open(number), selectors.EVENT_READ, (number, files[3]))


def report_exit(_: int, number: int, told: int) -> None:
    _, status = os.waitpid(number, 0)
    # Whoever asked may not want to know.
    with suppress(BrokenPipeError):
        os.write(told, f"{os.waitstatus_to_exitcode(status)}\n".encode())
    os.close(told)


def take_streams(files: list[int]) -> None:
    for standard, file in enumerate(files):
        os.dup2(file, standard)
        os.close(file)


def become(request: dict[str, Any]) -> dict[str, Any]:
    """Have this process be as Python with the request's arguments would be; the namespace to run them in."""
    own = {name: os.environ[name] for name in OF_LIBRARIES if name in os.environ}
    os.environ.clear()
    os.environ.update(request["environment"] | own)
    os.chdir(request["folder"])
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for number in RESET:
        signal.signal(number, signal.SIG_DFL)
    if "PYTHONUNBUFFERED" in os.environ:
        for name, file in (("stdout", 1), ("stderr", 2)):
            raw = io.FileIO(file, "w", closefd=False)
            setattr(sys, name, io.TextIOWrapper(raw, encoding="utf-8", write_through=True))
    module = types.ModuleType("__main__")
    sys.modules["__main__"] = module
    return module.__dict__


def run(arguments: list[str], namespace: dict[str, Any]) -> None:
    """Run ``-c CODE …``, ``-m MODULE …`` or ``SCRIPT …`` as Python does."""
    first, *rest = arguments
    if first == "-m":
        sys.argv = [rest[0], *rest[1:]]
        runpy.run_module(rest[0], run_name="__main__", alter_sys=True)
        return
    if first == "-c":
        sys.argv, sys.path[0] = ["-c", *rest[1:]], ""
        code = compile(rest[0], "<string>", "exec")
    else:
        sys.argv, sys.path[0] = arguments, str(Path(first).parent)
        code = compile(Path(first).read_bytes(), first, "exec")
        namespace["__file__"] = first
    exec(code, namespace)


def leave(exit_codes: list[int]) -> None:
    """End with the code that is known; to free what was imported takes longer than all else here."""
    if exit_codes:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(exit_codes[0])


if __name__ == "__main__":
    known: list[int] = []
    # The first that is registered is called last, after threads and all others.
    atexit.register(leave, known)
    import_everything()
    gc.collect()
    gc.freeze()
    asked = next_request(socket.socket(fileno=int(sys.argv[1])))
    try:
        run(asked["arguments"], become(asked))
        known.append(0)
    except SystemExit as ended:
        # Python prints what is no number.
        if ended.code is None or isinstance(ended.code, int):
            known.append((ended.code or 0) & 0xFF)
        raise
