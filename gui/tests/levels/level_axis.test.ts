// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from "vitest";
import {
  axisOf,
  boundsIn,
  limitsOf,
  moved,
  RATES,
  rounded,
  shareOf,
  stepOf,
  valueAt,
} from "../../src/levels/level_axis";

describe("the axis of rates", () => {
  const axis = axisOf([0, 0.5, 2, 30]);

  test("has room beside the lowest and the highest rate above 0", () => {
    expect(axis.low).toBeGreaterThan(0);
    expect(axis.low).toBeLessThan(0.5);
    expect(axis.high).toBeGreaterThan(30);
  });

  test("is there without any rate above 0", () => {
    expect(axisOf([0]).low).toBeLessThan(axisOf([0]).high);
  });

  test("leads from a rate to its place and back", () => {
    for (const rate_hz of [0.5, 2, 30]) expect(valueAt(axis, shareOf(axis, rate_hz))).toBeCloseTo(rate_hz, 9);
  });

  test("ends at its ends: nothing lies beside it", () => {
    expect([shareOf(axis, 0), shareOf(axis, 1e6)]).toEqual([0, 1]);
    expect([valueAt(axis, -3), valueAt(axis, 7)]).toEqual([axis.low, valueAt(axis, 1)]);
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
  expect([rounded(0.1234), rounded(4.56), rounded(123)]).toEqual([0.12, 4.6, 120]);
});

describe("a level that is moved", () => {
  const levels = [1, 2, 5, 10, 20, 50];

  test("goes where nothing is in its way", () => {
    expect(moved(RATES, levels, 2, 7)).toEqual({ levels: [1, 2, 7, 10, 20, 50], stoppedBy: null });
  });

  test("stops at its neighbours, which are named", () => {
    expect(moved(RATES, levels, 2, 1.5)).toEqual({ levels: [1, 2, 2, 10, 20, 50], stoppedBy: 1 });
    expect(moved(RATES, levels, 2, 11)).toEqual({ levels: [1, 2, 10, 10, 20, 50], stoppedBy: 3 });
  });

  test("stops at 0 Hz, where no level is", () => {
    expect(moved(RATES, levels, 0, -4)).toEqual({ levels: [0, 2, 5, 10, 20, 50], stoppedBy: null });
    expect(limitsOf(RATES, levels, 0)).toEqual([0, 2]);
  });

  test("leaves the levels from before as they were, to go back to", () => {
    moved(RATES, levels, 5, 40);
    expect(levels).toEqual([1, 2, 5, 10, 20, 50]);
  });
});

describe("an accuracy that is moved", () => {
  const kind = boundsIn("m");
  const levels = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01];

  test("stays tighter than the level before and wider than the next", () => {
    expect(moved(kind, levels, 1, 0.3)).toEqual({ levels: [0.5, 0.3, 0.1, 0.05, 0.02, 0.01], stoppedBy: null });
    expect(moved(kind, levels, 1, 0.6)).toEqual({ levels: [0.5, 0.5, 0.1, 0.05, 0.02, 0.01], stoppedBy: 0 });
    expect(moved(kind, levels, 1, 0.09)).toEqual({ levels: [0.5, 0.1, 0.1, 0.05, 0.02, 0.01], stoppedBy: 2 });
  });

  test("is never 0", () => {
    const { levels: after, stoppedBy } = moved(kind, levels, 5, 0);
    expect(after[5]).toBeGreaterThan(0);
    expect(stoppedBy).toBeNull();
  });
});

test("no level stands beyond the highest rate", () => {
  expect(moved(RATES, [1, 2, 5, 10, 20, 50], 5, 1e9).stoppedBy).toBeNull();
});
