// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { Timeline } from "../../src/state/timeline";

const COURSE = {
  duration_s: 7,
  bin_s: 1,
  first_bin_s: -0.5,
  path: [
    [0, 0, 0],
    [4, 4, 0],
    [6, 4, 2],
  ],
} as const;

test("the time begins at its zero, and stays within the recording", () => {
  const timeline = new Timeline(COURSE, 8, 5, [5]);
  expect(timeline.time.value).toBe(5);
  timeline.goTo(99);
  expect(timeline.time.value).toBe(7);
  timeline.goTo(-1);
  expect(timeline.time.value).toBe(0);
});

test("a time lies in the bin that covers it", () => {
  const timeline = new Timeline(COURSE, 8, 0, []);
  expect(timeline.binTimes.slice(0, 2)).toEqual([0, 1]);
  for (const [time, bin] of [
    [0.49, 0],
    [0.5, 1],
    [7, 7],
  ] as const) {
    timeline.goTo(time);
    expect(timeline.bin.value).toBe(bin);
  }
});

test("the robot is between the points of its path", () => {
  const timeline = new Timeline(COURSE, 8, 0, []);
  expect(timeline.placeAt(2)).toEqual({ place: [2, 0], heading_rad: 0 });
  expect(timeline.placeAt(5)).toEqual({ place: [4, 1], heading_rad: Math.PI / 2 });
  expect(timeline.placeAt(7)?.place).toEqual([4, 2]);
  expect(new Timeline({ ...COURSE, path: [] }, 8, 0, []).placeAt(1)).toBeNull();
});
