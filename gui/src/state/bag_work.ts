// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { watchProgress } from "../api/progress";
import { refusal } from "../api/refusal";

type WorkState<T> =
  | { kind: "idle"; note: string }
  | { kind: "running"; share: number }
  | { kind: "done"; answer: T }
  | { kind: "failed"; why: string };

/** Work of the server on a recording: one at a time, with its progress, and ended by `cancel`. */
export class BagWork<T> {
  readonly state = signal<WorkState<T>>({ kind: "idle", note: "" });
  private running: AbortController | null = null;

  async start(ask: (run: string, signal: AbortSignal) => Promise<T>): Promise<void> {
    this.cancel();
    const control = new AbortController();
    this.running = control;
    const run = `${Date.now()} ${Math.random()}`;
    const tell = (state: WorkState<T>) => {
      if (this.running === control) this.state.value = state;
    };
    tell({ kind: "running", share: 0 });
    const stop = watchProgress(run, (share) => tell({ kind: "running", share }));
    try {
      tell({ kind: "done", answer: await ask(run, control.signal) });
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
