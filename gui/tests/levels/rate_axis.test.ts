// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from "vitest";
import { axisOf, limitsOf, moved, rateAt, roundRate, shareOf, stepOf } from "../../src/levels/rate_axis";

describe("the axis of rates", () => {
  const axis = axisOf([0, 0.5, 2, 30]);

  test("has room beside the lowest and the highest rate above 0", () => {
    expect(axis.low_hz).toBeGreaterThan(0);
    expect(axis.low_hz).toBeLessThan(0.5);
    expect(axis.high_hz).toBeGreaterThan(30);
  });

  test("is there without any rate above 0", () => {
    expect(axisOf([0]).low_hz).toBeLessThan(axisOf([0]).high_hz);
  });

  test("leads from a rate to its place and back", () => {
    for (const rate_hz of [0.5, 2, 30]) expect(rateAt(axis, shareOf(axis, rate_hz))).toBeCloseTo(rate_hz, 9);
  });

  test("ends at its ends: nothing lies beside it", () => {
    expect([shareOf(axis, 0), shareOf(axis, 1e6)]).toEqual([0, 1]);
    expect([rateAt(axis, -3), rateAt(axis, 7)]).toEqual([axis.low_hz, rateAt(axis, 1)]);
  });
});

test.each([
  [0, 0.1],
  [0.05, 0.001],
  [1, 0.1],
  [9.9, 0.1],
  [10, 1],
  [1000, 100],
])("a key stroke at %d Hz moves a rate by %d Hz", (rate_hz, step_hz) => {
  expect(stepOf(rate_hz)).toBeCloseTo(step_hz, 12);
});

test("a dragged rate has two digits", () => {
  expect([roundRate(0.1234), roundRate(4.56), roundRate(123)]).toEqual([0.12, 4.6, 120]);
});

describe("a level that is moved", () => {
  const levels_hz = [1, 2, 5, 10, 20, 50];

  test("goes where nothing is in its way", () => {
    expect(moved(levels_hz, 2, 7)).toEqual({ levels_hz: [1, 2, 7, 10, 20, 50], stoppedBy: null });
  });

  test("stops at its neighbours, which are named", () => {
    expect(moved(levels_hz, 2, 1.5)).toEqual({ levels_hz: [1, 2, 2, 10, 20, 50], stoppedBy: 1 });
    expect(moved(levels_hz, 2, 11)).toEqual({ levels_hz: [1, 2, 10, 10, 20, 50], stoppedBy: 3 });
  });

  test("stops at 0 Hz, where no level is", () => {
    expect(moved(levels_hz, 0, -4)).toEqual({ levels_hz: [0, 2, 5, 10, 20, 50], stoppedBy: null });
    expect(limitsOf(levels_hz, 0)).toEqual([0, 2]);
  });

  test("leaves the levels from before as they were, to go back to", () => {
    moved(levels_hz, 5, 40);
    expect(levels_hz).toEqual([1, 2, 5, 10, 20, 50]);
  });
});
