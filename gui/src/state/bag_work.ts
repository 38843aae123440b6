// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { refusal } from "../api/client";
import type { Push } from "../api/types";

type WorkState<T> =
  | { kind: "idle"; note: string }
  | { kind: "running"; share: number }
  | { kind: "done"; answer: T }
  | { kind: "failed"; why: string };

/** Work of the server on a recording: one at a time, with its progress, and ended by `cancel`. */
export class BagWork<T> {
  readonly state = signal<WorkState<T>>({ kind: "idle", note: "" });
  private running: AbortController | null = null;

  /**
   * `ask` may call parts of its work `partOf(run, number)`, and `setShare` how far all is; `whole` is that
   * when the server is so far with a part.
   */
  async start(
    ask: (run: string, signal: AbortSignal, setShare: (share: number) => void) => Promise<T>,
    whole = (share: number, _part: number) => share,
  ): Promise<void> {
    this.cancel();
    const control = new AbortController();
    this.running = control;
    const run = `${Date.now()} ${Math.random()}`;
    const tell = (state: WorkState<T>) => {
      if (this.running === control) this.state.value = state;
    };
    const setShare = (share: number) => tell({ kind: "running", share });
    setShare(0);
    const stop = watchProgress(run, (share, part) => setShare(whole(share, part)));
    try {
      tell({ kind: "done", answer: await ask(run, control.signal, setShare) });
    } catch (error) {
      if (control.signal.aborted) return;
      tell({ kind: "failed", why: refusal(error) });
    } finally {
      stop();
    }
  }

  /** Ends the work; the server ends its process. */
  cancel(): void {
    this.running?.abort();
    this.running = null;
    this.state.value = { kind: "idle", note: this.state.peek().kind === "running" ? "Cancelled." : "" };
  }
}

const PART = " part ";

/** What part `number` of the work `run` is called. */
export function partOf(run: string, number: number): string {
  return run + PART + number;
}

/** Tells how far the work called `run`, or a part of it, is, 0 … 1, until what it returns is called. */
function watchProgress(run: string, tell: (share: number, part: number) => void): () => void {
  const socket = new WebSocket(new URL("ws", location.href.replace(/^http/, "ws")));
  socket.onmessage = ({ data }) => {
    const push = JSON.parse(String(data)) as Push;
    if (push.kind !== "progress") return;
    const [whole, part] = push.run.split(PART);
    if (whole === run) tell(push.share, Number(part ?? 0));
  };
  return () => {
    // A socket that is closed while it opens is an error in the browser's console.
    if (socket.readyState === WebSocket.CONNECTING) socket.onopen = () => socket.close();
    else socket.close();
  };
}
