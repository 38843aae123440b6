// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { covers, follow, offsetsOf, partAround, partAt } from "../../src/blocks/drawn_part";

const keys = (count: number) => Array.from({ length: count }, (_, index) => `k${index}`);

test("a short text is shown whole", () => {
  expect(partAround(30, 40)).toEqual({ first: 0, count: 40, total: 40 });
  expect(partAt(offsetsOf([10, 10, 10]), 12, 14)).toEqual({ first: 0, count: 3, total: 3 });
});

test("of a long text the rows that the view needs", () => {
  const offsets = offsetsOf(new Array(100).fill(10));
  expect(partAt(offsets, 95, 131)).toEqual({ first: 9, count: 5, total: 100 });
  expect(partAt(offsets, -50, 5)).toEqual({ first: 0, count: 1, total: 100 });
  expect(partAt(offsets, 2000, 2100)).toEqual({ first: 99, count: 1, total: 100 });
  expect(covers({ first: 5, count: 20, total: 100 }, partAt(offsets, 95, 131))).toBe(true);
  expect(covers({ first: 10, count: 20, total: 100 }, partAt(offsets, 95, 131))).toBe(false);
});

test("a part of a text that changed keeps its statements", () => {
  const before = keys(100);
  const part = { first: 50, count: 10, total: 100 };
  expect(follow(part, before, ["new", ...before])).toEqual({ first: 51, count: 10, total: 101 });
  expect(follow(part, before, before.toSpliced(55, 1))).toEqual({ first: 50, count: 9, total: 99 });
  expect(follow(part, before, before.slice(0, 99))).toEqual({ first: 50, count: 10, total: 99 });
  expect(follow(part, before, before.slice(0, 45))).toEqual({ first: 25, count: 20, total: 45 });
});
