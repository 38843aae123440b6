// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { violations } from "./axe";
import { boxOf, openPage, type RulerPage, resize, typedIn } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /scan 1
    Rule "Far"
    If (CheckValue /odom pose_y > 2 For 1 s)
    Then
        SetFrequency /scan 5
    EndIf
end
`;

test("typing and arrow keys move the line and escape leaves the rule as it was", async () => {
  const { ruler, values } = await openThreshold(RULES);
  const line = values.getByRole("slider", { name: "Threshold" });
  await expect.element(line).toHaveAttribute("aria-valuenow", "2");
  await commands.press("Control+a");
  await commands.type("6");
  await expect.element(line).toHaveAttribute("aria-valuenow", "6");
  await expect.element(values.getByRole("status")).toHaveTextContent(/^> 6: Holds for 0\.\d+ s/);
  await commands.press("ArrowUp");
  await expect.poll(() => typedIn(page.getByRole("textbox", { name: "value", exact: true }))).toBe("6.1");
  await commands.press("Escape");
  await expect.element(ruler.blocks.getByRole("button", { name: "Edit value: 2" })).toBeVisible();
  await ruler.expectLines("CheckValue /odom pose_y > 2 For 1 s");
});

test("what the recording lacks is said", async () => {
  const { values } = await openThreshold(RULES.replace("/odom pose_y", "/gripper force"));
  await expect.element(values).toHaveTextContent("monday has no values of /gripper force");
});

test.each([1280, 390])("the values are whole on every screen and fit for screen readers: %i", async (width) => {
  await resize(width, 844);
  const { values } = await openThreshold(RULES);
  await expect.element(values.getByRole("slider", { name: "Threshold" })).toBeInViewport({ ratio: 1 });
  await expect.element(values.getByRole("status")).toBeInViewport({ ratio: 1 });
  const { left, right } = await boxOf(values);
  expect(innerWidth).toBe(width);
  expect(left).toBeGreaterThanOrEqual(0);
  expect(right).toBeLessThanOrEqual(width);
  expect(await violations()).toEqual([]);
});

/** Opens the threshold of the only check of the rules; gives what stands below it, too. */
async function openThreshold(rules: string): Promise<{ ruler: RulerPage; values: Locator }> {
  const ruler = await openPage("two_drives", { files: { "monday.adirf": rules } });
  await ruler.open("monday.adirf");
  await (await ruler.field("Edit value: 2")).click();
  return { ruler, values: page.getByCss(".picker-chart") };
}
