// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { GRIP_PX, openPage, type RulerPage } from "./ruler_page";

const LOW_BATTERY = `\
begin
    SetFrequency /odom 1

    If CheckValue /battery_state level < 20 For 10 s
    Then
        SetFrequency /odom Full
        KeepWithin /odom position 0.05
    EndIf
end
`;
const ALL_TIMES = `\
begin
    // keep this
    Rule "Slow"  // and this
    If (CheckValue /odom speed < 0.10 // m/s
        AND (CheckValue /scan distance > 1 OR CheckValue /scan distance < 0.2))
    Then
        Record "stuck" /odom Before 30 s After 500 ms // all of it
        SetFrequency /scan 5.0
    EndIf
end
`;

test("the position is kept within 5 cm while the battery is low for 10 s", async () => {
  const ruler = await openNew("battery");
  await ruler.button("New rate").click();
  await ruler.change("Edit rate: 10", "1");
  await ruler.button("New rule").click();
  await ruler.change("Edit topic to check", "/battery_state");
  await ruler.change("Edit property: pose_x", "level");
  await (await ruler.field("dropdown: >")).click();
  await page.getByRole("option", { name: "<", exact: true }).click();
  await ruler.change("Edit value: 0", "20");
  await addTime(ruler, "for so long…");
  await ruler.expectLines("CheckValue /battery_state level < 20 For 10 s");
  await ruler.change("Edit rate: 10", "Full");
  await (await ruler.field("Add bound")).click();
  await ruler.change("Edit bound", "0.05");
  await ruler.expectLines("KeepWithin /odom position 0.05");
  await ruler.save();
  expect(await ruler.saved("low.adirf")).toBe(LOW_BATTERY);

  await ruler.openPane("Try on a recording");
  await ruler.button("Run the rules on it").click();
  await ruler.shown(page.getByText(/[\d.]+ % less/));
  const loss = page.getByRole("region", { name: "What the operator loses" });
  const errors = loss.getByRole("table", { name: "Error when the last received value is held" });
  await expect.element(errors.getByRole("row", { name: "/odom pose_y" })).toHaveTextContent("m");
  const decisions = page.getByRole("region", { name: "Decisions" }).getByRole("row");
  await expect.element(decisions.filter({ hasText: "23.0" })).toHaveTextContent("Full");
});

test("times stand inside or outside of a not", async () => {
  const ruler = await openNew("empty");
  const check = ruler.blocks.getByRole("figure", { name: "/odom, pose_x" });
  await ruler.button("New rule").click();
  await ruler.change("Edit value: 0", "1");
  await dragBelow(ruler, "Checks", "/odom", check);
  await addTime(ruler, "for so long…");
  await ruler.expectLines("(CheckValue /odom pose_x > 1 AND CheckValue /odom pose_x > 0 For 10 s)");
  await (await ruler.field("Remove this check")).click();
  await ruler.expectLines("If CheckValue /odom pose_x > 1", "Then");
  // What Blockly removes is shown a moment longer, as it shrinks.
  await expect.poll(() => check.length).toBe(1);
  await dragBelow(ruler, "Checks", "not", check);
  await (await ruler.field("Add check")).click();
  await addTime(ruler, "for so long…");
  await ruler.expectLines("AND Not CheckValue /odom pose_x > 0 For 10 s)");
  const group = ruler.blocks.getByRole("figure", { name: "not" }).first();
  await group.click({ button: "right", position: { x: GRIP_PX, y: GRIP_PX } });
  await choose("for so long…");
  await ruler.change("Edit duration: 10", "20");
  await ruler.expectLines("AND (Not CheckValue /odom pose_x > 0 For 10 s) For 20 s)");
});

test("a time is given and taken away with the keyboard alone", async () => {
  const ruler = await openNew("empty");
  await ruler.button("New rule").click();
  await ruler.expectLines("CheckValue /odom pose_x > 0");
  await commands.press("Escape");
  await ruler.walk("ArrowLeft", "/odom, pose_x");
  await ruler.walk("ArrowRight", "Add time");
  await commands.press("Enter");
  await ruler.shown(page.getByRole("menuitem", { name: "for so long…" }));
  await commands.press("Enter");
  await ruler.shown(page.getByRole("textbox", { name: "duration" }));
  await ruler.typeValue("3");
  await ruler.expectLines("CheckValue /odom pose_x > 0 For 3 s");
  await ruler.walk("ArrowRight", "Remove this time");
  await commands.press("Enter");
  await expect.element(ruler.text).not.toHaveTextContent("For");
  await expect.element(ruler.blocks.getByRole("button", { name: "Add time" })).toHaveFocus();
});

test("a copied rule keeps what it records and bounds", async () => {
  const ruler = await openPage("empty", { files: { "slow.adirf": ALL_TIMES } });
  await ruler.open("slow.adirf");
  await (await ruler.field("Add bound")).click();
  await ruler.change("Edit bound", "0.2");
  await ruler.expectLines("KeepWithin /odom position 0.2");
  const rule = ruler.blocks.getByRole("figure", { name: "rule" }).first();
  await rule.click({ position: { x: GRIP_PX, y: GRIP_PX } });
  await commands.press("Control+c", "Control+v");
  const names = ruler.blocks.getByRole("button", { name: "Edit name of the rule: Slow" });
  await expect.poll(() => names.length).toBe(2);
  await ruler.change("Edit name of the rule: Slow", "Copy");
  await ruler.expectLines(
    'Rule "Slow"',
    "/odom Before 30 s After 500 ms // all of it",
    "KeepWithin /odom position 0.2",
    'Rule "Copy"',
    'Record "stuck" /odom Before 30 s After 500 ms',
    "KeepWithin /odom position 0.2",
  );
});

async function dragBelow(ruler: RulerPage, category: string, name: string, above: Locator): Promise<void> {
  await page.getByRole("treeitem", { name: category }).click();
  const blocks = page.getByRole("listbox", { name: `${category} blocks` });
  await ruler.drag(blocks.getByRole("option", { name }).first(), above, 0, 0);
}

async function openNew(project: string): Promise<RulerPage> {
  const ruler = await openPage(project);
  await ruler.button("New Rule File").click();
  await page.getByLabelText("Name").fill("low");
  await ruler.button("Create").click();
  return ruler;
}

async function addTime(ruler: RulerPage, choice: string): Promise<void> {
  await (await ruler.field("Add time")).click();
  await choose(choice);
}

async function choose(choice: string): Promise<void> {
  await page.getByRole("menuitem", { name: choice, exact: true }).click();
  // It opens by itself to type into.
  await page.getByCss("input:focus").findElement();
}
