// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { Statement } from "../../src/api/types";
import { Folds } from "../../src/state/statements";

const rules = (...keys: string[]) => keys.map((key) => ({ kind: "rule", key }) as unknown as Statement);
const many = rules(...Array.from({ length: 21 }, (_, index) => `k${index}`));
const folded = (folds: Folds, statements: readonly Statement[]) => statements.map((each) => folds.isFolded(each));

test("more than twenty rules begin folded, defaults never do", () => {
  const folds = new Folds();
  folds.follow([], many);
  expect(new Set(folded(folds, many))).toEqual(new Set([true]));
  expect(folds.isFolded({ kind: "keep", key: "k1" } as unknown as Statement)).toBe(false);
  const few = new Folds();
  few.follow([], many.slice(1));
  expect(folded(few, many).some(Boolean)).toBe(false);
});

test("a rule whose words change stays as it is, and a new one is open", () => {
  const folds = new Folds();
  folds.follow([], many);
  folds.set(many[3] as Statement, false);
  const changed = many.with(3, rules("x")[0] as Statement).with(4, rules("y")[0] as Statement);
  folds.follow(many, changed);
  expect(folded(folds, changed.slice(2, 6))).toEqual([true, false, true, true]);
  folds.follow(changed, [...changed, ...rules("new")]);
  expect(folded(folds, rules("new"))).toEqual([false]);
});
