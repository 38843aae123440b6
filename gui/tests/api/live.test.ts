// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { LiveSocket } from "../../src/api/live";
import { serve } from "../state/served";

/** A connection to a server that is away, or back. */
class Connection {
  static openings: number[] = [];
  static isAway = true;
  static last: Connection;
  onmessage: (event: { data: string }) => void = () => {};
  onclose: () => void = () => {};

  constructor() {
    Connection.openings.push(Date.now());
    Connection.last = this;
    if (Connection.isAway) queueMicrotask(() => this.onclose());
  }
}

beforeEach(() => {
  vi.useFakeTimers({ now: 0 });
  serve({});
  vi.stubGlobal("location", { href: "http://localhost/" });
  vi.stubGlobal("WebSocket", Connection);
  Connection.openings = [];
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** The pauses between the tries of so many ms. */
async function pauses(ms: number): Promise<number[]> {
  const begun = Connection.openings.length - 1;
  await vi.advanceTimersByTimeAsync(ms);
  return Connection.openings
    .slice(begun + 1)
    .map((opened, index) => opened - (Connection.openings[begun + index] ?? 0));
}

test("a server that is away is asked after twice the time each, at most every 8 s, and soon again once it was heard", async () => {
  const socket = new LiveSocket({ onPush: () => {}, onLost: () => {} });
  socket.open();
  expect(await pauses(35_000)).toEqual([500, 1000, 2000, 4000, 8000, 8000, 8000]);
  Connection.isAway = false;
  expect(await pauses(20_000)).toEqual([8000]);
  Connection.last.onmessage({ data: "{}" });
  Connection.isAway = true;
  Connection.last.onclose();
  await vi.advanceTimersByTimeAsync(500);
  expect(await pauses(3500)).toEqual([1000, 2000]);
  socket.close();
  expect(await pauses(20_000)).toEqual([]);
});
