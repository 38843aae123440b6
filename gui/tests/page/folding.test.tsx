// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { boxOf, openPage, type RulerPage } from "./ruler_page";

/** More than are blocks at once. */
const COUNT = 60;
const HALL = 10;

test("a long text has an outline with its sections", async () => {
  const rules = Array.from({ length: COUNT }, (_, number) => {
    const heading = number % HALL === 0 ? `\n    // ---- Hall ${number / HALL} ----\n` : "";
    return heading + rule(number);
  });
  const text = `begin\n    SetFrequency /odom 10\n${rules.join("")}end\n`;
  const ruler = await openPage("empty", { files: { "folded.adirf": text } });
  await ruler.open("folded.adirf");
  const drawn = ruler.blocks.getByCss(".blocklyBlockCanvas > .blocklyDraggable");
  await drawn.first().findElement();
  const outline = page.getByRole("listbox", { name: "Rules in the order of the text" });
  await expect.poll(() => outline.getByRole("option").length).toBe(COUNT + 1);
  const hall = outline.getByRole("group", { name: "Hall 4", exact: true });
  await expect.poll(() => hall.getByRole("option").length).toBe(HALL);
  await expect.element(hall.getByRole("option").first()).toHaveTextContent("/sensor_40 4 Hz");
  expect(drawn.length).toBeLessThan(COUNT / 2);
  await expect.element(folded(ruler, 3)).toBeInViewport();
  await hall.getByRole("option", { name: "Aisle 43" }).click();
  const name = ruler.blocks.getByRole("button", { name: "Edit name of the rule: Aisle 43" });
  await expect.element(name).toBeInViewport();
  const heading = ruler.blocks.getByCss(".section-heading").getByText("Hall 4", { exact: true });
  await expect.poll(() => heading.length).toBe(1);
  await expect.element(ruler.text.getByText('"Aisle 43"')).toBeInViewport();
  // By the keys of the list, and by the wheel.
  await ruler.press(outline, "End", "ArrowUp", "Enter");
  const last = ruler.blocks.getByRole("button", { name: `Edit name of the rule: Aisle ${COUNT - 2}` });
  await expect.element(last).toBeInViewport();
  await wheel(ruler, -100_000);
  await expect.element(folded(ruler, 0)).toBeInViewport();
  await wheel(ruler, 100_000);
  await expect.element(folded(ruler, COUNT - 1)).toBeInViewport();
  await ruler.button("Unfold all").click();
  await expect.poll(() => ruler.blocks.getByCss(".adirf_folded").length).toBe(0);
  expect(drawn.length).toBeLessThan(COUNT / 2);
  await ruler.button("Fold all").click();
  await expect.poll(() => ruler.blocks.getByCss(".adirf_rule").length).toBe(0);
});

function rule(number: number): string {
  return `
    Rule "Aisle ${number}"
    If CheckValue /odom pose_x > ${number}
    Then
        SetFrequency /sensor_${number} 4
        SetFrequency /scan Full
    EndIf
`;
}

function folded(ruler: RulerPage, number: number): Locator {
  return ruler.blocks.getByRole("button", { name: `Unfold Aisle ${number}`, exact: true });
}

async function wheel(ruler: RulerPage, downPx: number): Promise<void> {
  const { right, top } = await boxOf(ruler.blocks.getByCss(".blocks-host"));
  await commands.mouseMove(right - 60, top + 60);
  await commands.mouseWheel(0, downPx);
}
