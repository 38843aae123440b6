# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An object store on the loopback that counts what it sends."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

BUCKET = "fleet"


@dataclass(kw_only=True)
class ObjectStore:
    """S3 at ``url`` with one bucket; ``sent_bytes`` are those of all answers so far.

    It refuses what is asked of it of files once there were ``fails_after`` ``ranges`` asked for.
    """

    url: str = ""
    sent_bytes: int = 0
    ranges: int = 0
    fails_after: int | None = None
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def counted(self, application: Callable[..., Iterable[bytes]]) -> Callable[..., Iterator[bytes]]:
        def answer(environ: dict[str, Any], start_response: Any) -> Iterator[bytes]:
            with self._lock:
                self.ranges += "HTTP_RANGE" in environ
            if "HTTP_RANGE" in environ and self.fails_after is not None and self.ranges > self.fails_after:
                start_response("403 Forbidden", [("Content-Length", "0")])
                return
            for piece in application(environ, start_response):
                with self._lock:
                    self.sent_bytes += len(piece)
                yield piece

        return answer

    def put(self, path: Path, key: str) -> None:
        """Store the file, or all files of the folder, at ``path`` as ``key``."""
        import boto3  # noqa: PLC0415  only full tests need it
        from s3fs import S3FileSystem  # noqa: PLC0415  only full tests need it

        # What this process was told of the store before is no longer true.
        S3FileSystem.clear_instance_cache()
        client = boto3.client("s3", endpoint_url=self.url)
        for file in [path] if path.is_file() else path.rglob("*"):
            if file.is_file():
                client.upload_file(str(file), BUCKET, f"{key}/{file.relative_to(path)}".removesuffix("/."))


@contextmanager
def object_store() -> Iterator[ObjectStore]:
    import boto3  # noqa: PLC0415  only full tests need it
    from botocore.config import Config  # noqa: PLC0415  only full tests need it
    from moto.moto_server.werkzeug_app import (  # noqa: PLC0415  only full tests need it
        DomainDispatcherApplication,
        create_backend_app,
    )
    from werkzeug.serving import make_server  # noqa: PLC0415  only full tests need it

    store = ObjectStore()
    application = DomainDispatcherApplication(create_backend_app)
    server = make_server("127.0.0.1", 0, store.counted(application), threaded=True)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        store.url = f"http://127.0.0.1:{server.port}"
        # The first request has it import most of itself.
        patient = Config(read_timeout=600)
        boto3.client("s3", endpoint_url=store.url, config=patient).create_bucket(Bucket=BUCKET)
        yield store
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
