// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Push } from "./types";

/** Tells how far the work called `run` is, 0 … 1, until what it returns is called. */
export function watchProgress(run: string, tell: (share: number) => void): () => void {
  const socket = new WebSocket(new URL("ws", location.href.replace(/^http/, "ws")));
  socket.onmessage = ({ data }) => {
    const push = JSON.parse(String(data)) as Push;
    if (push.kind === "progress" && push.run === run) tell(push.share);
  };
  return () => {
    // A socket that is closed while it opens is an error in the browser's console.
    if (socket.readyState === WebSocket.CONNECTING) socket.onopen = () => socket.close();
    else socket.close();
  };
}
