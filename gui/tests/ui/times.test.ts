// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { ago } from "../../src/ui/numbers";

const NOW_MS = new Date(2026, 10, 23, 12).getTime();
const S = 1000;
const HOUR = 3600 * S;

test.each([
  [5 * S, "just now"],
  [59 * S, "just now"],
  [60 * S, "1 minute ago"],
  [59 * 60 * S, "59 minutes ago"],
  [HOUR, "1 hour ago"],
  [23 * HOUR, "23 hours ago"],
  [24 * HOUR, "yesterday"],
  [13 * 24 * HOUR, "13 days ago"],
  [20 * 24 * HOUR, "3 Nov 2026"],
])("what was %d ms ago is %s", (ms, text) => {
  expect(ago(NOW_MS - ms, NOW_MS)).toBe(text);
});
