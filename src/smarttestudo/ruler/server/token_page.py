# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page for whoever opens an address of the server without a token of it."""

from __future__ import annotations

from starlette.responses import HTMLResponse, Response

_TEXT = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>ADIRF Ruler</title>
<meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark">
<style>
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 40rem; margin: 3rem auto; padding: 0 1rem }
</style>
<main>
<h1>The token is missing or wrong</h1>
<p>Open the whole address that <code>testudo ruler</code> printed in its terminal, with all that follows
<code>?token=</code>. It prints another one each time that it is started.</p>
<p>A link that somebody copied from the page has no token. Open the printed address in this browser once;
then the link works, too.</p>
<p>If you did not start <code>testudo ruler</code>, ask whoever did. Nothing that this browser keeps of your
work is lost.</p>
</main>
</html>
"""


def token_page(status: int) -> Response:
    """The answer, with ``status``, to a browser that shows what it is sent."""
    return HTMLResponse(_TEXT, status_code=status)
