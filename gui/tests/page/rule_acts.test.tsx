// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { openPage, type RulerPage, twoPictures } from "./ruler_page";

const THREE = `\
begin
    SetFrequency /odom 10

    // Why there is A.
    Rule "A"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4  // enough
    EndIf

    Rule "B"
    If CheckValue /odom pose_x > 2
    Then
        SetFrequency /odom 5
    EndIf
end
`;
const OFF = THREE.replace('Rule "A"', 'Disabled Rule "A"');

test("a rule is switched off and on", async () => {
  const ruler = await openThree();
  const off = ruler.blocks.getByText("⊘ switched off");
  await ruler.blocks.getByRole("button", { name: "Switch this rule off" }).first().click();
  await expect.poll(() => off.length).toBe(1);
  expect(await saved(ruler)).toBe(OFF);
  await ruler.shown(page.getByText('"A" is switched off'));
  await ruler.button("Switch this rule on").click();
  await expect.poll(() => off.length).toBe(0);
  expect(await saved(ruler)).toBe(THREE);
});

test("a copy has what was typed just before", async () => {
  const ruler = await openThree();
  await (await ruler.field("Edit rate: 4")).click();
  await commands.press("Control+a");
  await commands.type("7");
  // By its name: the block of the open field comes behind the others in the page a picture later.
  const name = page.getByRole("button", { name: "Edit name of the rule: A", exact: true });
  const rule = ruler.blocks.getByCss(".adirf_rule").filter({ has: name });
  await rule.getByRole("button", { name: "Duplicate this rule" }).click();
  await ruler.field("Edit name of the rule: A 2");
  expect((await saved(ruler)).split("SetFrequency /odom 7")).toHaveLength(3);
});

test("what is opened while a copy is made stays open", async () => {
  const ruler = await openThree();
  const release = ruler.network.hold("POST /api/edit");
  await ruler.blocks.getByRole("button", { name: "Duplicate this rule" }).first().click();
  await expect.poll(() => ruler.network.count("POST /api/edit")).toBe(1);
  await page.getByRole("treeitem", { name: "Recipes" }).click();
  const recipe = page.getByRole("listbox", { name: "Recipes blocks" }).getByRole("option").first();
  await ruler.shown(recipe);
  release();
  await ruler.field("Edit name of the rule: A 2");
  await twoPictures();
  expect(recipe.element()).toBeVisible();
});

test("a copy stands behind its rule with all comments", async () => {
  const ruler = await openThree();
  await ruler.blocks.getByRole("button", { name: "Duplicate this rule" }).first().click();
  await ruler.field("Edit name of the rule: A 2");
  const block = THREE.slice(THREE.indexOf("    // Why"), THREE.indexOf('    Rule "B"'));
  expect(await saved(ruler)).toBe(THREE.replace(block, block + block.replace('"A"', '"A 2"')));
});

test("a rule moves with its comments", async () => {
  const ruler = await openThree();
  await move(ruler, "A", "down");
  await ruler.expectLines('Rule "B"', "// Why there is A.", 'Rule "A"');
  // The blocks follow the text: then the focus is on the rule that moved.
  await ruler.awaitFocus("rule, A");
  await move(ruler, "A", "up");
  await ruler.expectLines("// Why there is A.", 'Rule "A"', 'Rule "B"');
  await expect.element(await ruler.tool("Save")).toBeDisabled();
});

test("by keyboard alone", async () => {
  const ruler = await openThree();
  const off = ruler.blocks.getByText("⊘ switched off");
  await ruler.walk("Tab", "stacks of blocks");
  await ruler.walk("ArrowDown", "rule, A", 3);
  await ruler.walk("ArrowRight", "Switch this rule off", 8);
  await commands.press("Enter");
  await expect.poll(() => off.length).toBe(1);
  await ruler.awaitFocus("rule, A");
  await ruler.walk("ArrowRight", "Switch this rule on", 8);
  await ruler.walk("ArrowRight", "Duplicate this rule", 3);
  await commands.press("Enter");
  await ruler.field("Edit name of the rule: A 2");
  await expect.poll(() => off.length).toBe(2);
  await commands.press("Control+s");
  await ruler.shown(page.getByText("Saved three.adirf"));
  expect((await ruler.saved("three.adirf")).split("Disabled Rule")).toHaveLength(3);
});

test("keys that come faster than pictures keep the focus", async () => {
  const ruler = await openThree();
  await ruler.walk("Tab", "stacks of blocks");
  // As a browser that is busy gets them.
  for (let count = 0; count < 2; count++) {
    const key = new KeyboardEvent("keydown", { key: "ArrowDown", keyCode: 40, bubbles: true });
    document.activeElement?.dispatchEvent(key);
  }
  await twoPictures();
  await twoPictures();
  expect(ruler.focused).toContain("rule, A");
});

test("the menu of a rule offers the same", async () => {
  const ruler = await openThree();
  const rule = page.getByCss(".adirf_rule, .blocklyDraggable").filter({ hasText: "rule" }).first();
  await rule.click({ button: "right", position: { x: 20, y: 8 } });
  const menu = page.getByCss(".blocklyContextMenu");
  const entry = (name: string) => menu.getByText(name, { exact: true });
  for (const name of ["Switch this rule off", "Duplicate this rule", "Move this rule up", "Move this rule down"])
    await expect.poll(() => entry(name).length).toBe(1);
  expect(menu.getByText("Disable Block").length).toBe(0);
  await entry("Move this rule down").click();
  await ruler.expectLines('Rule "B"', 'Rule "A"');
});

/** By the menu of its block. */
async function move(ruler: RulerPage, rule: string, where: "up" | "down"): Promise<void> {
  const name = page.getByRole("button", { name: `Edit name of the rule: ${rule}`, exact: true });
  const block = ruler.blocks.getByCss(".adirf_rule").filter({ has: name });
  await block.click({ button: "right", position: { x: 60, y: 8 } });
  await page.getByCss(".blocklyContextMenu").getByText(`Move this rule ${where}`, { exact: true }).click();
}

async function openThree(): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "three.adirf": THREE } });
  await ruler.open("three.adirf");
  await ruler.field("Edit name of the rule: B");
  return ruler;
}

async function saved(ruler: RulerPage): Promise<string> {
  await ruler.save();
  return ruler.saved("three.adirf");
}
