// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { CHAPTERS } from "virtual:documentation";
import { expect, test } from "vitest";
import { anchorOf } from "../../documentation/chapters";

const TEXT = CHAPTERS.map(({ html }) => html).join("");
const ANCHORS = [...CHAPTERS.map(({ anchor }) => anchor), ...[...TEXT.matchAll(/ id="([^"]*)"/g)].map(([, id]) => id)];

test("every place of the documentation has an anchor of its own", () => {
  expect(ANCHORS).toContain("blocks-clash");
  expect(ANCHORS.filter((anchor, at) => ANCHORS.indexOf(anchor) !== at)).toEqual([]);
});

test("every link leads to a place on the page, so that none needs the network", () => {
  const targets = [...TEXT.matchAll(/ (?:href|src)="([^"]*)"/g)].map(([, target]) => target);
  expect(targets).toContain("#/help/levels");
  for (const target of targets) expect(ANCHORS.map((anchor) => `#/help/${anchor}`)).toContain(target);
});

test.each([
  ["#grammar", "grammar"],
  ["reference/checks.md", "findings"],
  ["reference/checks-rates.md#blocks-clash", "blocks-clash"],
  ["./quality-levels.md", "levels"],
  ["decisions/0007.md", null],
  ["../examples/quality/radio.toml", null],
  ["https://docs.ros.org/", null],
  ["javascript:alert(1)", null],
])("%j in docs/language.md leads to %j", (link, anchor) => {
  expect(anchorOf(link, "docs/language.md")).toBe(anchor);
});
