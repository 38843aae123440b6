// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { needOf } from "../../src/levels/curve_tables";

const points = [
  { bound: 0.4, hold_hz: 1, reckoned_hz: null },
  { bound: 0.2, hold_hz: 2, reckoned_hz: null },
  { bound: 0.1, hold_hz: 5.4321, reckoned_hz: null },
];

test("a measured bound needs what was measured, in three digits", () => {
  expect(needOf(points, 0.2)).toEqual({ hz: 2, isMeasured: true });
  expect(needOf(points, 0.1)).toEqual({ hz: 5.43, isMeasured: true });
});

test("between two bounds the need lies on the line between theirs", () => {
  expect(needOf(points, 0.3)).toEqual({ hz: 1.5, isMeasured: false });
});

test("a wider bound than all needs what the widest does, and of a tighter one nothing is known", () => {
  expect(needOf(points, 9)).toEqual({ hz: 1, isMeasured: false });
  expect(needOf(points, 0.09)).toBeNull();
});
