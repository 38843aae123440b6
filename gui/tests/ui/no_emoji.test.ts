// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";

const FILES = import.meta.glob<string>("../../src/**/*.{ts,tsx,css}", {
  query: "?raw",
  import: "default",
  eager: true,
});
/** What a browser draws as an emoji, or looks for in a font of emoji, which may not be there. */
const EMOJI = /\p{Extended_Pictographic}|\u{FE0F}/u;
/** Signs that DejaVu Sans, which most desktops with Linux have, does not have. */
const RARE = /[\u{2900}-\u{297F}\u{2B00}-\u{2BFF}\u{1F000}-\u{1FFFF}]/u;
/** They count as emoji, and are in every font. */
const LETTERS = /[©®™]/gu;

test("no sign of the page needs a font of emoji", () => {
  expect(Object.keys(FILES).length).toBeGreaterThan(100);
  const found = Object.entries(FILES).filter(([, text]) => {
    const signs = text.replace(LETTERS, "");
    return EMOJI.test(signs) || RARE.test(signs);
  });
  expect(found.map(([name]) => name)).toEqual([]);
});
