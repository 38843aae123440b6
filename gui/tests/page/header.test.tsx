// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, onTestFinished, test } from "vitest";
import { page } from "vitest/browser";
import { boxOf, openPage, resize } from "./ruler_page";

const WIDTHS_PX = [1440, 1280, 820, 390];
const HEIGHT_PX = 844;
const ZONE = `\
begin
    If (
        CheckValue /odom pose_y > 1
        AND CheckValue /odom pose_y < 5.4
    )
    Then
        SetFrequency /odom 4
end
`;
const INSPECTION = "quality/inspection.adirf";
const RADIO = "quality/radio.toml";
const FILES = {
  "zone.adirf": ZONE,
  [INSPECTION]: "begin\n    SetFrequency /odom Marginal\nend\n",
  [RADIO]: '[topics."/odom"]\nmessage_kb = 0.72\n',
};

test.each(WIDTHS_PX)("the bar is one row of which nothing is cut: %i", async (widthPx) => {
  await resize(widthPx, HEIGHT_PX);
  const ruler = await openPage("empty", { files: FILES });
  await ruler.open(INSPECTION);
  await expectOneRow();
  await ruler.button("New rate").click();
  await expect.element(await ruler.tool("Save")).toBeEnabled();
  await expectOneRow();
});

test.each(WIDTHS_PX)("the bar of topic parameters is one row as well: %i", async (widthPx) => {
  await resize(widthPx, HEIGHT_PX);
  const ruler = await openPage("empty", { files: FILES });
  await page.getByRole("link", { name: RADIO, exact: true }).click();
  await ruler.shown(page.getByLabelText("Topic of row 1", { exact: true }));
  await expectOneRow();
});

test("the bar has five things, of which none changes, and a menu", async () => {
  const ruler = await openPage("empty", { files: FILES });
  await ruler.open("zone.adirf");
  const bar = page.getByRole("toolbar", { name: "Tools" });
  await ruler.shown(ruler.button("Menu"));
  const shown = bar.getByRole("button").elements();
  expect(shown.map((each) => each.getAttribute("aria-label") || "Menu")).toEqual([
    "Save",
    "Undo",
    "Redo",
    "Send to robot",
    "Optimize and Download",
    "Menu",
  ]);
  await ruler.button("Menu").click();
  const entries = bar.getByRole("menu", { name: "Menu" }).getByRole("menuitem");
  await ruler.shown(entries.first());
  const names = entries.elements().map((each) => (each as HTMLElement).innerText.split("\n")[0]);
  expect(names).toEqual(["Versions", "Keys"]);
  for (const [name, keys] of [
    ["Save", "Ctrl+S"],
    ["Undo", "Ctrl+Z"],
    ["Redo", "Ctrl+Shift+Z"],
  ] as const)
    await expect.element(await ruler.tool(name)).toHaveAttribute("title", `${name} (${keys})`);
});

test("the menu closes where somebody presses elsewhere", async () => {
  const ruler = await openPage("empty", { files: FILES });
  await ruler.open("zone.adirf");
  await ruler.shown(await ruler.tool("Versions"));
  await ruler.text.click();
  await expect.element(page.getByRole("menu")).not.toBeInTheDocument();
});

test("text on blocks has 13 pixels and the font of the page", async () => {
  const ruler = await openPage("empty", { files: FILES });
  await ruler.open("zone.adirf");
  await ruler.field("Edit value");
  const texts = [...document.querySelectorAll<SVGTextElement>(".blocklyBlockCanvas text.blocklyText")];
  const found = texts.map((each) => {
    const { fontSize, fontFamily } = getComputedStyle(each);
    return { px: Number.parseFloat(fontSize) * (each.getCTM()?.a ?? 0), fontFamily };
  });
  expect(ruler.blocks.element().contains(texts[0] as Node)).toBe(true);
  expect(found.length).toBeGreaterThan(5);
  expect(Math.min(...found.map(({ px }) => px))).toBeGreaterThanOrEqual(13);
  expect(new Set(found.map(({ fontFamily }) => fontFamily))).toEqual(
    new Set([getComputedStyle(document.body).fontFamily]),
  );
});

test.each([
  [1440, 2],
  [820, 2],
  [390, 2],
  [195, 1],
])("the name is read where the text is twice as large: %i, %i", async (widthPx, factor) => {
  await resize(widthPx, HEIGHT_PX);
  const ruler = await openPage("empty", { files: FILES });
  await ruler.open(INSPECTION);
  document.documentElement.style.fontSize = `${100 * factor}%`;
  onTestFinished(() => void document.documentElement.style.removeProperty("font-size"));
  await ruler.shown(ruler.button("Menu"));
  const seen = inTheBar();
  const named = seen.filter(({ name }) => name === INSPECTION);
  expect(named).toHaveLength(1);
  const wrong = seen.filter((each) => !each.isInside || (named.includes(each) && each.isCut));
  expect(wrong.map(({ name }) => name)).toEqual([]);
  expect((await boxOf(page.getByRole("heading", { name: INSPECTION }))).width).toBeGreaterThanOrEqual(80 * factor);
});

/** Of what is in the bar: whether all of it is seen, and where it is. */
function inTheBar() {
  const seen = [...document.querySelectorAll(".bar :is(h1, a, button, .quiet)")].filter(
    (each) => each.checkVisibility() && !each.closest("[role=menu], [role=tooltip]"),
  );
  return seen.map((each) => {
    const { left, right, top } = each.getBoundingClientRect();
    const isCut =
      (each.scrollWidth > each.clientWidth + 1 && each.clientWidth > 0) ||
      (each.scrollHeight > each.clientHeight + 3 && each.tagName === "H1");
    const isInside = left >= 0 && right <= innerWidth;
    return { name: each.getAttribute("aria-label") ?? each.textContent ?? "", isCut, isInside, top };
  });
}

async function expectOneRow(): Promise<void> {
  const seen = inTheBar();
  expect(seen.length).toBeGreaterThan(6);
  expect(seen.filter(({ isCut, isInside }) => isCut || !isInside).map(({ name }) => name)).toEqual([]);
  expect((await boxOf(page.getByRole("banner"))).height).toBeLessThanOrEqual(72);
  const topsPx = seen.filter(({ name }) => /^(Save|Undo|Redo|Menu)/.test(name)).map(({ top }) => top);
  expect(Math.max(...topsPx) - Math.min(...topsPx)).toBeLessThan(2);
}
