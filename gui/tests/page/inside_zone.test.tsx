// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { MapPage } from "./map_page";
import { openPage, type RulerPage } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 10

    Rule "Corridor"
    If (
        CheckValue /odom pose_x > 1.0
        AND CheckValue /odom pose_x < 5
        AND CheckValue /odom pose_y > 2
        AND CheckValue /odom pose_y < 6 // the wall
    )
    Then
        SetFrequency /odom 4
    EndIf

    Rule "Bay"
    If (
        CheckValue /odom speed < 0.5
        AND CheckValue /odom pose_y < 3.5
        AND CheckValue /odom pose_y > 0
        AND CheckValue /odom pose_x >= 10
        AND CheckValue /odom pose_x < 14
    )
    Then
        SetFrequency /odom 7
    EndIf
end
`;

test("a zone is one part by its name, in whose place another of the file can be", async () => {
  const ruler = await openZones();
  expect(ruler.blocks.getByRole("button", { name: /^Edit value/ })).toHaveLength(1);
  await (await zone(ruler, "Corridor")).click();
  await ruler.shown(option("Bay"));
  const words = page.getByCss(".blocklyDropDownContent [role=option]").elements();
  expect(words.map((each: Element) => each.textContent)).toEqual([
    "Corridor",
    "Bay",
    "Draw on the map",
    "Show the numbers",
  ]);
  await option("Bay").click();
  await ruler.expectLines("pose_y < 3.5", "pose_y > 0", "pose_x >= 10", "pose_x < 14", "SetFrequency /odom 4");
  await expect.poll(() => ruler.blocks.getByRole("button", { name: "zone: Corridor" }).length).toBe(2);
  await ruler.use("Undo");
  await expect.poll(() => ruler.blocks.getByRole("button", { name: "zone: Bay" }).length).toBe(1);
  await ruler.expectLines("pose_x > 1.0", "pose_y < 6 // the wall");
});

test("the numbers of a zone are shown, changed and hidden without a mouse", async () => {
  const ruler = await openZones();
  await choose(ruler, "Corridor", "Show the numbers");
  // The first number is open to type into, and Tab leads to the others.
  await expect.poll(() => document.activeElement?.getAttribute("aria-label")).toBe("value");
  await commands.type("1.5");
  await commands.press("Enter");
  await ruler.expectLines("pose_x > 1.5", "pose_x < 5", "pose_y < 6 // the wall");
  expect(ruler.blocks.getByRole("button", { name: /^Edit value/ })).toHaveLength(5);
  await ruler.use("Undo");
  await ruler.expectLines("pose_x > 1.0");
  await expect.poll(() => ruler.blocks.getByRole("button", { name: /^Edit value/ }).length).toBe(5);
  await choose(ruler, "Corridor", "Hide the numbers");
  await expect.poll(() => ruler.blocks.getByRole("button", { name: /^Edit value/ }).length).toBe(1);
  await ruler.expectLines("pose_x > 1.0", "pose_y < 6 // the wall");
});

test("a zone is drawn anew on the map in the place of its numbers", async () => {
  const ruler = await openZones();
  await (await zone(ruler, "Bay")).click();
  await option("Draw on the map").click();
  await expect.element(ruler.button("Draw a rectangle")).toHaveAttribute("aria-pressed", "true");
  await expect.element(ruler.button("Draw a rectangle")).toHaveFocus();
  const hint = getComputedStyle(await page.getByText("Press where one corner is").findElement());
  expect(hint.color).not.toBe(hint.backgroundColor);
  await commands.press("Escape");
  await expect.element(ruler.button("Draw a rectangle")).toHaveAttribute("aria-pressed", "false");
  await ruler.openPane("Text");
  await (await zone(ruler, "Bay")).click();
  await option("Draw on the map").click();
  const map = await MapPage.open(ruler);
  await map.drag([1.5, 2.5], [3.5, 4.5]);
  await expect.element(ruler.button("Draw a rectangle")).toHaveAttribute("aria-pressed", "false");
  await expect.element(ruler.button("Bay")).toHaveAttribute("aria-pressed", "true");
  await expect.poll(() => Math.abs(Number(map.sides()[0]) - 1.5)).toBeLessThan(0.3);
  const [left, right, low, high] = map.sides();
  await ruler.openPane("Text");
  await ruler.expectLines("pose_y < 6 // the wall", "speed < 0.5", `pose_y < ${high}`, `pose_y > ${low}`);
  await ruler.expectLines(`pose_x >= ${left}`, `pose_x < ${right}`);
});

async function openZones(): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "zones.adirf": RULES } });
  await ruler.open("zones.adirf");
  await ruler.shown(ruler.blocks.getByRole("button", { name: "zone: Corridor" }));
  return ruler;
}

function zone(ruler: RulerPage, name: string): Promise<Locator> {
  return ruler.field(`zone: ${name}`);
}

/** Opens the list of a zone and takes a line of it, by keys. */
async function choose(ruler: RulerPage, name: string, line: string): Promise<void> {
  await commands.press("/");
  await commands.type(name);
  await ruler.shown(page.getByRole("option", { name: `Rule ${name}` }));
  await commands.press("Enter");
  await ruler.awaitFocus(`rule, ${name}`);
  await ruler.walk("ArrowDown", `inside, ${name}`);
  await ruler.walk("ArrowRight", `zone: ${name}`);
  await commands.press("Enter");
  await ruler.shown(option(line));
  // Where the list points is said of the list, which has the focus.
  const pointedAt = () => {
    const id = document.activeElement?.getAttribute("aria-activedescendant");
    return id ? document.getElementById(id)?.textContent : "";
  };
  for (let step = 0; step < 6 && pointedAt() !== line; step++) await commands.press("ArrowDown");
  await commands.press("Enter");
}

function option(name: string): Locator {
  return page.getByRole("option", { name });
}
