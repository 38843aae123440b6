// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { boxOf, GRIP_PX, openPage, type RulerPage, resize } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 10

    Rule "A"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4
    EndIf
end
`;
const PAGE = ["Undo", "Redo"];

test("the menu of a default has a comment and that of the ground new blocks", async () => {
  const ruler = await openOne();
  const lines = await menuOf(page.getByCss(".blocklyBlockCanvas > .adirf_set"));
  expect(textsOf(lines)).toEqual(["Add a comment", "Remove this rate", ...PAGE]);
  await commands.press("Escape");
  const host = ruler.blocks.getByCss(".blocks-host");
  const { width } = await boxOf(host);
  await host.click({ button: "right", position: { x: width - 150, y: 30 } });
  await expect
    .poll(() => textsOf(lines))
    .toEqual([...["New rate", "New rule", "New floor", "New bound"], ...["Fold all", "Unfold all", ...PAGE]]);
  await page.getByRole("menuitem", { name: "New rate" }).click();
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /", "Rule");
});

test("a menu undoes what the page undoes", async () => {
  const ruler = await openOne();
  await ruler.change("Edit rate: 4", "7");
  await ruler.expectLines("SetFrequency /odom 7");
  await (await menuOf(page.getByCss(".adirf_rule"))).filter({ hasText: "Undo" }).click();
  await ruler.expectLines("SetFrequency /odom 4");
});

test("a menu is not cut at the edge of the pane", async () => {
  const ruler = await openOne();
  await resize(1440, 520);
  const host = await boxOf(ruler.blocks.getByCss(".blocks-host"));
  const last = await boxOf((await menuOf(page.getByCss(".adirf_rule"))).last());
  expect(last.top).toBeGreaterThan(host.bottom);
  // What covers it would take the click.
  const seen = document.elementFromPoint(last.left + last.width / 2, last.top + last.height / 2);
  expect(seen?.textContent?.trim()).toBe("Redo");
});

test("a comment opens to type into and stays only with a text", async () => {
  const ruler = await openOne();
  const rule = page.getByCss(".adirf_rule");
  await (await menuOf(rule)).filter({ hasText: "Add a comment" }).click();
  await expect.poll(() => page.getByCss("textarea:focus").length).toBe(1);
  await commands.type("Why there is A.");
  await commands.press("Escape");
  await ruler.expectLines("// Why there is A.", 'Rule "A"');
  const lines = (await menuOf(rule)).filter({ hasText: "comment" });
  expect(textsOf(lines)).toEqual(["Edit the comment", "Remove the comment"]);
  await page.getByRole("menuitem", { name: "Remove the comment" }).click();
  await expect.element(ruler.text).not.toHaveTextContent("Why there is A.");
  await expect.element(await ruler.tool("Save")).toBeDisabled();
});

test("tab goes from topic to property operator and value", async () => {
  const ruler = await openOne();
  await (await ruler.field("Edit topic to check: /odom")).click();
  for (const typed of ["/pose", "pose_y"]) {
    await commands.press("Control+a");
    await commands.type(typed);
    await commands.press("Tab");
  }
  await ruler.shown(page.getByRole("option", { name: "<", exact: true }));
  await commands.press("ArrowDown", "Tab");
  await ruler.typeValue("3");
  await ruler.expectLines("CheckValue /pose pose_y < 3");
});

test("enter takes the first line of the clock and its duration is ready", async () => {
  const ruler = await openDuration();
  await ruler.typeValue("25");
  await ruler.expectLines("CheckValue /odom pose_x > 1 For 25 s");
});

test("a letter on a field is a letter and no shortcut", async () => {
  const ruler = await openOne();
  await ruler.walk("Tab", "stacks of blocks");
  await ruler.walk("ArrowDown", "set frequency of", 2);
  await ruler.walk("ArrowRight", "Edit topic to send", 4);
  await commands.type("/tmp");
  await commands.press("Enter");
  await ruler.expectLines("SetFrequency /tmp");
  await expect.element(page.getByRole("combobox", { name: "Find a rule" })).not.toHaveFocus();
});

test("a duration below nothing stays open with the reason", async () => {
  const ruler = await openDuration();
  await ruler.typeValue("-5");
  await ruler.shown(page.getByText("-5 is less than 0"));
  expect(ruler.isOpen("Edit duration")).toBe(true);
  await ruler.typeValue("5");
  await ruler.expectLines("For 5 s");
});

async function openOne(): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "one.adirf": RULES } });
  await ruler.open("one.adirf");
  await ruler.field("Edit name of the rule: A");
  return ruler;
}

async function openDuration(): Promise<RulerPage> {
  const ruler = await openOne();
  await (await ruler.field("Add time")).click();
  await commands.press("Enter");
  await ruler.shown(page.getByRole("textbox", { name: "duration" }));
  return ruler;
}

/** The lines of the menu of a block. */
async function menuOf(block: Locator): Promise<Locator> {
  const path = block.getByCss("> .blocklyPath").first();
  const { width } = await boxOf(path);
  // At its right end is neither a field nor what hangs from an icon.
  await path.click({ button: "right", position: { x: width - 4, y: GRIP_PX } });
  const lines = page.getByRole("menuitem");
  await lines.first().findElement();
  return lines;
}

function textsOf(lines: Locator): string[] {
  return lines.elements().map((line) => (line.textContent ?? "").trim());
}
