// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { foundSections } from "../../src/documentation/found_sections";

const SECTIONS = [
  { title: "Rates", chapter: "The language", text: "A number in Hz, or a level such as Desirable." },
  { title: "Levels", chapter: "Quality levels", text: `${"Many words come first. ".repeat(9)}A rate has six levels.` },
];
const titles = (query: string) => foundSections(SECTIONS, query).map(({ section }) => section.title);

test("every word has to be there, in the heading or below it", () => {
  expect(titles("hz")).toEqual(["Rates"]);
  expect(titles("SIX rate")).toEqual(["Levels"]);
  expect(titles("six Hz")).toEqual([]);
});

test("what has a word in its heading comes first", () => {
  expect(titles("level")).toEqual(["Levels", "Rates"]);
});

test("nothing is looked for without a word", () => {
  expect(titles("  ")).toEqual([]);
});

test("the excerpt has the first word, and whole words around it", () => {
  const [found] = foundSections(SECTIONS, "six");
  expect(found?.excerpt).toMatch(/^… .*\bA rate has six levels\.$/);
  expect(found?.excerpt.length).toBeLessThan(120);
});
