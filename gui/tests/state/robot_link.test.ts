// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Live } from "../../src/api/types";
import { RING_LENGTH, RobotLink } from "../../src/state/robot_link";
import { linkOf, robotOf } from "./told_robots";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.restoreAllMocks();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** A page that watches a robot which sends a status every `periodMs`, with the rate of one topic. */
function watching(periodMs: number) {
  const link = linkOf(robotOf("/ada"));
  link.watch();
  const hear = (actual_hz: number, afterMs = periodMs) => {
    vi.advanceTimersByTime(afterMs);
    const status = { status_hz: 1000 / periodMs, topics: { "/scan": { actual_hz } } };
    link.onPush({ kind: "live", node: "/ada", status } as unknown as Live);
  };
  return { link, hear };
}

/** How many samples there are of each rate. */
function counts(link: RobotLink): Record<string, number> {
  const found: Record<string, number> = {};
  for (let age = 0; age < RING_LENGTH; age++) {
    const rate = String(link.rates.of("/scan").at(age));
    found[rate] = (found[rate] ?? 0) + 1;
  }
  return found;
}

test("of the time that a robot was silent no rate is drawn", () => {
  const { link, hear } = watching(200);
  hear(2, 0);
  for (let sample = 1; sample < 10; sample++) hear(2);
  hear(10, 30_000);
  expect(counts(link)).toEqual({ NaN: RING_LENGTH - 11, 2: 10, 10: 1 });
});

test("a status stands for the time since the one before, also from a robot that sends few", () => {
  const { link, hear } = watching(5000);
  hear(2, 0);
  for (let status = 0; status < 4; status++) hear(2);
  expect(counts(link)).toEqual({ NaN: RING_LENGTH - 101, 2: 101 });
});

test("as many updates a second as somebody asked for are asked for on the next visit", () => {
  const link = linkOf(robotOf("/ada"));
  expect(link.updateHz.value).toBe(5);
  link.updateAt(1);
  expect(new RobotLink().updateHz.value).toBe(1);
});

test("a server is not gone because the computer stood still, and is when it says nothing after that", () => {
  vi.stubGlobal("window", globalThis);
  vi.stubGlobal("addEventListener", () => undefined);
  vi.stubGlobal("location", { href: "http://localhost/" });
  const link = linkOf(robotOf("/ada"));
  vi.stubGlobal("WebSocket", class {});
  let stoodStillMs = 0;
  const now = performance.now.bind(performance);
  vi.spyOn(performance, "now").mockImplementation(() => now() + stoodStillMs);
  link.open();
  vi.advanceTimersByTime(1000);
  stoodStillMs = 60_000;
  vi.advanceTimersByTime(1000);
  expect(link.isServerGone.value).toBe(false);
  vi.advanceTimersByTime(10_000);
  expect(link.isServerGone.value).toBe(true);
});
