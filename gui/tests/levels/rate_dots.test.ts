// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { placeAt } from "../../src/levels/rate_dots";

test.each([0.5, 2, 7, 30])("a dot at %d Hz is where it was at the last message, and moves with each", (rate_hz) => {
  const steps = 1000;
  const places = Array.from({ length: steps }, (_, at) => placeAt((at + 0.5) / (100 * rate_hz), rate_hz));
  for (const [at, place] of places.entries()) {
    expect(place).toBe(placeAt(Math.floor(at / 100) / rate_hz + 1e-9, rate_hz));
    expect(place).toBeGreaterThanOrEqual(0);
    expect(place).toBeLessThanOrEqual(1);
  }
});
