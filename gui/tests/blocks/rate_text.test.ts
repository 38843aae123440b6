// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { parseRate, RATE_WORDS, rateText } from "../../src/blocks/field_text";

test.each([
  ["10", { kind: "hz", value: 10 }],
  ["2,5 Hz", { kind: "hz", value: 2.5 }],
  ["0.1hz", { kind: "hz", value: 0.1 }],
  [" full ", { kind: "full", value: null }],
  ["OFF", { kind: "off", value: null }],
  ["desirable", { kind: "tier", value: "Desirable" }],
])("%j is understood as a rate", (text, rate) => {
  expect(parseRate(text)).toEqual(rate);
});

test.each(["", "Hz", "-1", "fast", "Infinity", "1e999", "10 kHz"])("%j is no rate", (text) => {
  expect(parseRate(text)).toBeNull();
});

test("what a block shows of a rate means the same when it is typed", () => {
  for (const text of [...RATE_WORDS, "0", "0.25", "1000000"]) {
    const rate = parseRate(text);
    expect(rate && rateText(rate)).toBe(text);
  }
});
