// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { boxOf, openPage, type RulerPage, resize } from "./ruler_page";

const CLASH = `\
begin
    SetFrequency /odom 10

    Rule "Aisle"
    If (CheckValue /odom pose_x > 1 AND CheckValue /odom speed < -1)
    Then
        SetFrequency /odom 4
    EndIf

    Rule "Bay"
    If CheckValue /odom pose_x > 5
    Then
        SetFrequency /odom 2
    EndIf

    Rule "Dock"
    If CheckValue /odom pose_y > 5
    Then
        SetFrequency /odom 8
    EndIf
end
`;
/** More than are blocks at once. */
const MANY = 41;

test("clashing rules are a pair with a way to both", async () => {
  const ruler = await openRules("clash", CLASH);
  const others = page.getByRole("group", { name: "Other statements that this is about" });
  const clash = page.getByRole("list", { name: "Findings" }).getByRole("listitem").filter({ has: others }).first();
  const spot = ruler.text.getByCss(".spot").first();
  await clash.getByRole("button", { name: "Show Rule Bay" }).click();
  await expect.element(ruler.text).toHaveFocus();
  await expect.element(spot).toHaveTextContent("Bay");
  await clash.getByRole("button", { name: "Rule Dock", exact: true }).click();
  await expect.element(spot).toHaveTextContent("SetFrequency /odom 8");
});

test("a name makes its folder and one that is not shown is refused with the real cause", async () => {
  const ruler = await openPage("empty");
  await ruler.button("New Rule File").click();
  const dialog = page.getByRole("dialog");
  await dialog.getByLabelText("Name").fill(".a/b c");
  await dialog.getByRole("button", { name: "Create" }).click();
  await expect.element(dialog.getByRole("alert")).toHaveTextContent("The Ruler shows no files of such a folder");
  await dialog.getByLabelText("Name").fill("a/b c");
  await dialog.getByRole("button", { name: "Create" }).click();
  await ruler.shown(ruler.blocks);
  expect(await ruler.saved("a/b c.adirf")).toBe("begin\nend\n");
});

test("what is not saved is still there after a look at the first screen", async () => {
  const ruler = await openRules("clash", CLASH);
  await ruler.button("New rate").click();
  await expect.element(await ruler.tool("Save")).toBeEnabled();
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  const entry = page.getByRole("listitem").filter({ hasText: "clash.adirf" });
  await expect.element(entry).toHaveTextContent("not saved");
  await ruler.open("clash.adirf");
  await expect.element(await ruler.tool("Save")).toBeEnabled();
  await ruler.use("Undo");
  await expect.element(await ruler.tool("Save")).toBeDisabled();
});

test("the bar on top keeps its height whatever it tells", async () => {
  await resize(1280, 800);
  const name = "the_patrol_of_monday_morning_in_the_warehouse";
  const ruler = await openRules(name, CLASH);
  const heightPx = () => document.querySelector("header")?.offsetHeight;
  const before = heightPx();
  expect(before).toBeLessThan(60);
  const last = await boxOf(await ruler.tool("Optimize and Download"));
  expect(last.right).toBeLessThanOrEqual(1280);
  await ruler.button("New rate").click();
  await expect.element(await ruler.tool("Save")).toBeEnabled();
  expect(heightPx()).toBe(before);
  await expect.element(page.getByRole("heading", { name })).toHaveAttribute("title", `${name}.adirf`);
});

test("of very many rules a part is blocks and follows what is looked at", async () => {
  const ruler = await openRules("many", manyRules());
  await page.getByRole("option", { name: "Zone 19", exact: false }).first().click();
  await ruler.blocks.getByRole("button", { name: "Edit name of the rule: Zone 19", exact: true }).click();
  await ruler.typeValue("Gate");
  await ruler.expectLines('Rule "Gate"');
  await ruler.text.click();
  await commands.press("Control+End", "ArrowUp", "ArrowUp");
  await expect.element(ruler.blocks.getByRole("button", { name: `Unfold Zone ${MANY - 1}` })).toBeInViewport();
  await ruler.button("New rate").click();
  await commands.press("Escape");
  const outline = page.getByRole("listbox", { name: "Rules in the order of the text" });
  await expect.poll(() => outline.getByRole("option").length).toBe(MANY + 2);
  expect(page.getByCss(".blocklyBlockCanvas .blocklyDraggable").length).toBeLessThan(MANY);
  await ruler.save();
  // The new rate is of a topic that had none.
  const added = / {4}SetFrequency \/(?!odom )\S+ 10\n/g;
  const text = await ruler.saved("many.adirf");
  expect(text).toMatch(added);
  expect(text.replace(added, "")).toBe(manyRules().replace('"Zone 19"', '"Gate"'));
});

function manyRules(): string {
  const rules = Array.from(
    { length: MANY },
    (_, number) =>
      `    Rule "Zone ${number}"\n    If CheckValue /odom pose_x > ${number}\n    Then\n` +
      "        SetFrequency /odom 4\n    EndIf\n",
  );
  return `begin\n    SetFrequency /odom 10\n\n${rules.join("\n")}end\n`;
}

async function openRules(name: string, text: string): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { [`${name}.adirf`]: text } });
  await ruler.open(`${name}.adirf`);
  await ruler.shown(ruler.blocks.getByRole("button", { name: "Remove this" }).first());
  return ruler;
}
