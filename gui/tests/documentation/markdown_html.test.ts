// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { markdownHtml } from "../../documentation/markdown_html";

const html = (markdown: string) => markdownHtml(markdown, "docs/language.md").trim();

test("the title is left to the page, and headings below it have GitHub's anchors", () => {
  expect(html("# Rules\n\n## What a `file` means, 1/2")).toBe(
    '<h3 id="what-a-file-means-12">What a <code>file</code> means, 1/2</h3>',
  );
});

test("a heading that stands twice in a document has two anchors", () => {
  expect(html("## Units\n\n## Units")).toMatch(/id="units"[\s\S]*id="units-1"/);
});

test.each([
  "<script>alert(1)</script>",
  "Read <b onclick=alert(1)>this</b>",
  "<div>\n\n<img src=x onerror=alert(1)>",
  "![<img src=x>](picture.png)",
  '[x](javascript:alert(1) "<i>")',
  "<https://example.org/>",
  "| a |\n|---|\n| <u>b</u> |",
  "```\n<i>\n```",
])("no HTML and no foreign address of %j passes", (markdown) => {
  expect(html(markdown)).not.toMatch(/<(script|b|i|u|div(?! class="table-scroll")|img|a)[ >]|href|src="/);
});

test("what looks like HTML is read as it was written", () => {
  expect(html("A rate of `/<robot>/scan`, or <topic>")).toBe(
    "<p>A rate of <code>/&lt;robot&gt;/scan</code>, or &lt;topic&gt;</p>",
  );
});

test("comments are for those who write the document", () => {
  expect(html("<!-- Written by a script -->\n# Findings\n\nWhat it says.")).toBe("<p>What it says.</p>");
});

test("links between documents stay on the page, and only the words of others stay", () => {
  expect(html("[levels](quality-levels.md), [loss](loss.md#x)")).toBe(
    '<p><a href="#/help/levels">levels</a>, loss</p>',
  );
});

test("wide tables and code can be scrolled, tables are told by their headers", () => {
  const table = html("| unit |\n|---|\n| Hz |");
  expect(table).toMatch(/^<div class="table-scroll" tabindex="0"><table class="reference">/);
  expect(table).toContain('<th scope="col">unit</th>');
  expect(html("| unit | |\n|---|---|\n| Hz | rate |")).toContain("unit</th>\n<td></td>");
  expect(html("```adirf\nbegin\n```")).toMatch(/^<pre tabindex="0"><code/);
});
