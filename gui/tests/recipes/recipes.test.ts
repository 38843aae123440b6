// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { RECIPES } from "../../src/recipes/recipes";

test("each recipe has a title of its own, and says what it is for", () => {
  expect(RECIPES.length).toBeGreaterThan(0);
  expect(new Set(RECIPES.map(({ title }) => title)).size).toBe(RECIPES.length);
  for (const { title, about } of RECIPES) {
    expect(title).toMatch(/^[A-Z]/);
    expect(about).toMatch(/\.$/);
  }
});

test("a recipe is a whole rule file", () => {
  for (const { text } of RECIPES) expect(text).toMatch(/\nbegin\n[\s\S]*\nend\n$/);
});
