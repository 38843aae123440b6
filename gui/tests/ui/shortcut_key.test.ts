// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { shortcutKey } from "../../src/ui/watch";

test.each([
  ["s", "KeyS", "s"],
  ["S", "KeyS", "s"],
  ["ы", "KeyS", "s"],
  ["Я", "KeyZ", "z"],
  ["ζ", "KeyZ", "z"],
  ["y", "KeyZ", "y"],
  ["é", "KeyZ", "é"],
  [";", "KeyZ", ";"],
  ["Enter", "Enter", "enter"],
])("%j on the place of %s is the shortcut %j", (key, code, shortcut) => {
  expect(shortcutKey({ key, code })).toBe(shortcut);
});
