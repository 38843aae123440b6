// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { boxOf, type Opening, openPage, type RulerPage, resize } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 10

    Rule "Same"
    If CheckValue /odom pose_x > 11
    Then
        SetFrequency /odom 10
    EndIf
end
`;

const results = () => page.getByRole("region", { name: "Results" });
const finding = () => page.getByRole("list", { name: "Findings" }).getByRole("button", { name: "Rule Same" });

test("rules open as blocks alone, and what somebody unfolds stays as they left it", async () => {
  const ruler = await openRules({ isFolded: true });
  await ruler.shown(ruler.pane("Findings (1)"));
  await expect.element(results()).not.toBeInTheDocument();
  await expect.element(ruler.text).not.toBeInTheDocument();
  const alone = await boxOf(ruler.blocks);
  const place = await boxOf(ruler.pane("Text"));
  await ruler.press(ruler.pane("Text"), "Enter");
  await ruler.expectLines("SetFrequency /odom 10");
  await ruler.press(ruler.pane("Try on a recording"), "Space");
  await ruler.shown(results().getByRole("heading", { name: "Try on a recording" }));
  await expect.element(ruler.pane("Text")).toHaveAttribute("aria-expanded", "true");
  await expect.element(ruler.pane("Map")).toHaveAttribute("aria-expanded", "false");
  // The buttons stand still while panes come and go.
  expect(await boxOf(ruler.pane("Text"))).toEqual(place);
  expect((await boxOf(ruler.blocks)).width).toBeLessThan(alone.width);
  await ruler.reload();
  await ruler.expectLines("SetFrequency /odom 10");
  await ruler.shown(results());
  await ruler.pane("Text").click();
  await ruler.pane("Try on a recording").click();
  await expect.element(ruler.text).not.toBeInTheDocument();
  await expect.element(results()).not.toBeInTheDocument();
  expect(await boxOf(ruler.blocks)).toEqual(alone);
});

test("a finding leads to its block where the text is folded, and unfolds the text where there is no block", async () => {
  const ruler = await openRules({ isFolded: true });
  await ruler.pane("Findings (1)").click();
  await finding().click();
  await ruler.awaitFocus("rule, Same");
  await expect.element(ruler.text).not.toBeInTheDocument();
  await ruler.write({ "same.adirf": RULES.replace("If CheckValue", "If CheckValu") });
  dispatchEvent(new Event("focus"));
  await ruler.shown(page.getByText("the blocks show how it was before"));
  await page.getByRole("list", { name: "Findings" }).getByCss(".link").first().click();
  await expect.element(ruler.text).toHaveFocus();
});

test("text that somebody leaves is formatted, and not while they write", async () => {
  const ruler = await openRules();
  await ruler.text.getByText("begin").click();
  await commands.press("End");
  await commands.type("\nSetFrequency    /scan   3");
  await ruler.shown(ruler.blocks.getByRole("button", { name: "Edit topic to send: /scan" }));
  const second = () => document.querySelectorAll(".cm-line")[1]?.textContent;
  expect(second()).toBe("SetFrequency    /scan   3");
  await ruler.pane("Findings (1)").click();
  await expect.poll(second).toBe("    SetFrequency /scan 3");
  await ruler.use("Undo");
  await expect.poll(second).toBe("SetFrequency    /scan   3");
});

test.each([1280, 820, 390])(
  "on every screen nothing is beside the page, and Save stays in sight: %i",
  async (width) => {
    await resize(width, 844);
    const ruler = await openRules();
    for (const pane of ["Map", "Try on a recording", "Text"]) {
      await ruler.pane(pane).click();
      await expect.poll(() => document.documentElement.scrollWidth).toBeLessThanOrEqual(width);
    }
    results().element().scrollIntoView({ block: "end" });
    await expect.element(await ruler.tool("Save")).toBeInViewport();
    await page.getByRole("link", { name: "Topics" }).click();
    await ruler.button("Add topic").click();
    for (let row = 0; row < 15; row++) await ruler.button("Add topic").click();
    ruler.button("Add topic").element().scrollIntoView({ block: "end" });
    await expect.element(await ruler.tool("Save")).toBeInViewport();
  },
);

async function openRules(opening: Opening = {}): Promise<RulerPage> {
  const ruler = await openPage("empty", { ...opening, files: { "same.adirf": RULES } });
  await ruler.open("same.adirf");
  await ruler.shown(ruler.blocks.getByRole("button", { name: "Edit topic to send" }).first());
  return ruler;
}
