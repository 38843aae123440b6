// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, onTestFinished, test } from "vitest";
import { commands, page } from "vitest/browser";
import { expectOrder, gaps, type Stack, stacks, textView } from "./block_stacks";
import { GRIP_PX, openPage, type RulerPage, twoPictures } from "./ruler_page";

test("a rule that grows keeps its place and the next gives way", async () => {
  const ruler = await openNew();
  for (let count = 0; count < 2; count++) await ruler.button("New rule").click();
  await ruler.expectLines("CheckValue /odom pose_x > 0", "CheckValue /odom pose_x > 0");
  await commands.press("Escape");
  await expectOrder();
  const [first] = stacks() as [Stack];
  const [gap] = gaps() as [number];
  for (let count = 0; count < 4; count++) {
    await ruler.blocks.getByRole("button", { name: "Add check" }).first().click();
    await commands.press("Escape");
  }
  await expect.poll(() => ruler.blocks.getByRole("button", { name: "Remove this check" }).length).toBe(6);
  await expectOrder();
  const [grown] = stacks() as [Stack];
  expect(Math.abs(grown.top - first.top)).toBeLessThanOrEqual(1);
  expect(Math.abs((gaps()[0] as number) - gap)).toBeLessThanOrEqual(1);
});

test("what is typed in stays where it is when something comes above", async () => {
  const ruler = await openNew();
  await ruler.button("New rate").click();
  await ruler.button("New rule").click();
  await ruler.expectLines("SetFrequency /odom 10", "CheckValue /odom pose_x > 0");
  await (await ruler.field("Edit name of the rule")).click();
  await expectOrder();
  const before = await topOfOpenName();
  // Somebody draws a zone, or an edit that was under way is answered: here the text says so.
  textView().dispatch({ changes: { from: "begin".length, insert: "\n    SetFrequency /scan 3" } });
  await ruler.blocks.getByRole("button", { name: "Edit topic to send: /scan" }).findElement();
  await expectOrder();
  expect(Math.abs((await topOfOpenName()) - before)).toBeLessThanOrEqual(1);
  await commands.press("Escape");
  await expectOrder();
});

test("a block that is dragged above another stands so in the text", async () => {
  const ruler = await openRules("a", "b", "c");
  // Marks of findings come with the next picture, and make room for themselves.
  await twoPictures();
  const of = (topic: string) => stacks().find(({ says }) => says[0] === topic) as Stack;
  const [grip, target] = [of("/c"), of("/a")];
  await commands.mouseMove(grip.left + GRIP_PX, grip.top + GRIP_PX);
  await commands.mouseDown();
  await commands.mouseMove(target.left + 60, target.top + GRIP_PX, 12);
  await commands.mouseUp();
  await ruler.expectLines("CheckValue /c", "CheckValue /a", "CheckValue /b");
  await expectOrder();
  expect(new Set(stacks().map(({ left }) => Math.round(left))).size).toBe(1);
  await ruler.use("Undo");
  await ruler.expectLines("CheckValue /a", "CheckValue /b", "CheckValue /c");
  await expectOrder();
});

test("blocks glide to their new place", async () => {
  onTestFinished(() => commands.emulateMotion("reduce"));
  await commands.emulateMotion("no-preference");
  const ruler = await openRules("a", "b");
  const gliding = watchGliding();
  await ruler.blocks.getByRole("button", { name: "Add check" }).first().click();
  await expect.poll(() => gliding.size).toBeGreaterThan(0);
  await expectOrder();
  expect(gliding.size).toBe(1);
});

test("blocks do not glide for somebody who wants no motion", async () => {
  const ruler = await openRules("a", "b");
  const gliding = watchGliding();
  await ruler.blocks.getByRole("button", { name: "Add check" }).first().click();
  await expect.poll(() => ruler.blocks.getByRole("button", { name: "Remove this check" }).length).toBe(3);
  await expectOrder();
  await twoPictures();
  expect(gliding.size).toBe(0);
});

async function openNew(): Promise<RulerPage> {
  const ruler = await openPage("empty");
  await ruler.button("New Rule File").click();
  await page.getByLabelText("Name").fill("fresh");
  await ruler.button("Create").click();
  await expect.element(ruler.button("New rate")).toBeEnabled();
  return ruler;
}

async function openRules(...topics: string[]): Promise<RulerPage> {
  const rules = topics.map(
    (topic) => `    If CheckValue /${topic} pose_x > 0\n    Then\n        SetFrequency /odom 3\n    EndIf\n`,
  );
  const ruler = await openPage("empty", { files: { "fresh.adirf": `begin\n${rules.join("")}end\n` } });
  await ruler.open("fresh.adirf");
  const copies = ruler.blocks.getByRole("button", { name: "Duplicate this rule" });
  await expect.poll(() => copies.length).toBe(topics.length);
  await expectOrder();
  return ruler;
}

/** Collects blocks as they begin to glide: a busy browser may draw no picture before they have arrived. */
function watchGliding(): Set<Element> {
  const gliding = new Set<Element>();
  const { animate } = Element.prototype;
  Element.prototype.animate = function (...how) {
    if (this.matches(".blocks-host .blocklyDraggable")) gliding.add(this);
    return animate.apply(this, how);
  };
  onTestFinished(() => {
    Element.prototype.animate = animate;
  });
  return gliding;
}

/** Where somebody types the name of the rule, once that lies on its block: it follows a picture later. */
async function topOfOpenName(): Promise<number> {
  const top = (selector: string) => document.querySelector(selector)?.getBoundingClientRect().top ?? Number.NaN;
  const typed = "input.blocklyHtmlInput";
  await expect
    .poll(() => Math.abs(top('.blocks-host [aria-label^="Edit name of the rule"]') - top(typed)))
    .toBeLessThan(2);
  return top(typed);
}
