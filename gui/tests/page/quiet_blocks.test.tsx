// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { boxOf, openPage, type RulerPage, resize, twoPictures } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 10

    Rule "Corridor"
    If CheckValue /odom pose_x > 11
    Then
        SetFrequency /odom 20
    EndIf
end
`;
const rule = (number: number) => `
    Rule "Aisle ${number}"
    If CheckValue /odom pose_x > ${number}
    Then
        SetFrequency /odom ${number + 20}
    EndIf
`;
const MANY = RULES.replace("end\n", `${[1, 2, 3, 4, 5, 6, 7, 8].map(rule).join("")}end\n`);

const findings = () => page.getByRole("list", { name: "Findings" }).getByRole("listitem");
const marks = () => page.getByCss(".finding-mark");

test("what is done with a rule is seen where somebody is at it", async () => {
  const ruler = await openRules(RULES);
  const remove = ruler.blocks.getByRole("button", { name: "Remove this rule" });
  const priority = ruler.blocks.getByRole("button", { name: "Edit priority of the rule: 0" });
  const seen = () => [remove, priority].map((each) => getComputedStyle(each.element()).opacity);
  expect(seen()).toEqual(["0", "0"]);
  await (await ruler.field("Edit name of the rule: Corridor")).hover();
  await expect.poll(seen).toEqual(["1", "1"]);
  await ruler.pane("Text").hover();
  await expect.poll(seen).toEqual(["0", "0"]);
  await ruler.walk("Tab", "stacks of blocks");
  await ruler.walk("ArrowDown", "rule, Corridor", 3);
  await expect.poll(seen).toEqual(["1", "1"]);
  expect(ruler.blocks.getByRole("button", { name: /^Move this rule/ }).length).toBe(0);
});

test("a new rule and a new check accuse nobody until they are changed or used, and move nothing", async () => {
  const ruler = await openRules(RULES);
  const name = await ruler.field("Edit name of the rule: Corridor");
  const { left } = await boxOf(name);
  await ruler.button("New rule").click();
  await ruler.expectLines("pose_x > 0", "SetFrequency /odom 10");
  await commands.press("Escape");
  await ruler.blocks.getByRole("button", { name: "Add check" }).first().click();
  await ruler.expectLines("pose_x > 11", "pose_x < 0");
  await twoPictures();
  expect([findings().length, marks().length]).toEqual([0, 0]);
  await ruler.typeValue("5");
  await ruler.shown(findings().filter({ hasText: "never hold" }));
  expect((await boxOf(name)).left).toBe(left);
  expect((await boxOf(marks().first())).right).toBeLessThan(left);
  await ruler.openPane("Try on a recording");
  await page.getByRole("button", { name: /^Findings/ }).click();
  await ruler.shown(findings().filter({ hasText: "changes nothing" }));
});

test("a mark has a shape for what it is, and opens what was found with the way to mend it", async () => {
  const ruler = await openRules(RULES.replace("EndIf", "Else\n        SetFrequency /scan 2\n    EndIf"));
  const mark = marks()
    .filter({ hasNot: page.getByCss("none") })
    .first();
  await mark.click();
  const bubble = page.getByRole("dialog", { name: "What was found here" });
  await ruler.shown(bubble);
  await expect.element(bubble).toHaveTextContent(/^(Warning|Note)\. /);
  await commands.press("Escape");
  await expect.poll(() => bubble.length).toBe(0);
  await mark.click();
  await bubble.getByRole("button").first().click();
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /scan");
  await expect.poll(() => bubble.length).toBe(0);
});

test("a selected block stands out from every ground, and the text goes to its rule", async () => {
  await resize(1440, 700);
  const ruler = await openRules(MANY);
  await page.getByRole("combobox", { name: "Find a rule" }).fill("Aisle 8");
  await commands.press("Enter");
  await ruler.awaitFocus("rule, Aisle 8");
  const path = () => document.querySelector(".blocklySelected > .blocklyPath") as Element;
  await expect.poll(() => path() && getComputedStyle(path()).stroke).toBe("rgb(255, 255, 255)");
  expect(getComputedStyle(path()).filter).toContain("drop-shadow(rgb(27, 35, 44)");
  const lines = () => [...document.querySelectorAll(".cm-line.spot")].map((each) => each.textContent?.trim());
  await expect.poll(lines).toContain('Rule "Aisle 8"');
  const line = page.getByCss(".cm-line.spot").first();
  const bottom = (await boxOf(page.getByRole("region", { name: "Results" }))).top;
  await expect.poll(async () => (await boxOf(line)).bottom).toBeLessThan(bottom);
});

test("a check that is added at the edge of the canvas comes into view, and stays there in a smaller one", async () => {
  await resize(1440, 800);
  const ruler = await openRules(MANY);
  const dock = () => boxOf(page.getByRole("region", { name: "Results" }));
  const field = () => document.activeElement as HTMLElement;
  await ruler.blocks.getByRole("button", { name: "Add check" }).nth(1).click();
  await expect.poll(() => field().tagName).toBe("INPUT");
  await expect.poll(async () => field().getBoundingClientRect().bottom < (await dock()).top).toBe(true);
  await resize(1440, 600);
  await expect.poll(async () => field().getBoundingClientRect().bottom < (await dock()).top).toBe(true);
  expect(field().tagName).toBe("INPUT");
});

test("what no list of blocks has is in the search", async () => {
  const ruler = await openRules(RULES);
  const names = page
    .getByRole("treeitem")
    .elements()
    .map((each) => each.textContent);
  expect(names).toEqual(["Actions", "Rules", "Checks", "Recipes"]);
  await commands.press("/");
  await commands.type("floor");
  await commands.press("Enter");
  await ruler.expectLines("KeepAtLeast /odom 1");
});

async function openRules(text: string): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "quiet.adirf": text } });
  await ruler.open("quiet.adirf");
  await ruler.field("Edit name of the rule: Corridor");
  return ruler;
}
