// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

/** More than are blocks at once. */
const NUMBERS = Array.from({ length: 50 }, (_, index) => 4 * index + 1);

function rule(number: number): string {
  const off = number === 77 ? "Disabled " : "";
  return `
    ${off}Rule "Aisle ${number}"
    If CheckValue /odom pose_x > ${number}
    Then
        SetFrequency /sensor_${number} ${number / 10}
    EndIf
`;
}

test("topics properties rates and limits narrow what is found", async () => {
  const ruler = await openMany();
  await commands.press("Control+f");
  const field = page.getByRole("combobox", { name: "Find a rule" });
  await expect.element(field).toHaveFocus();
  const search = page.getByCss("search");
  const found = search.getByRole("option");
  await expect.element(search.getByRole("status")).toHaveTextContent(/^50 of 50$/);
  for (const [words, count] of [
    ["/sensor_41", 1],
    ["pose_x > 41", 2],
    ["15.3 Hz", 1],
    ["pose_x aisle 5", 14],
    ["speed", 0],
  ] as const) {
    await field.fill(words);
    await expect.element(search.getByRole("status")).toHaveTextContent(new RegExp(`^${count} of 50$`));
  }
  await commands.press("Escape");
  await expect.element(field).toHaveValue("");
  await expect.poll(() => found.length).toBe(0);
  await field.fill("aisle");
  await ruler.button("Switched off").click();
  await expect.poll(() => found.length).toBe(1);
  await found.click();
  await seen(ruler, 77);
  await expect.element(ruler.button("Switch this rule on")).toBeInViewport();
});

test("the arrows choose among what is found", async () => {
  const ruler = await openMany();
  await page.getByRole("combobox", { name: "Find a rule" }).fill("aisle 5");
  await commands.press("ArrowDown", "ArrowDown", "ArrowDown", "ArrowUp", "Enter");
  // Aisle 5, 25, 45 and so on, in the order of the text.
  await seen(ruler, 45);
});

async function openMany(): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "many.adirf": `begin\n${NUMBERS.map(rule).join("")}end\n` } });
  await ruler.open("many.adirf");
  await ruler.field("Unfold Aisle 1");
  return ruler;
}

async function seen(ruler: RulerPage, number: number): Promise<void> {
  const name = ruler.blocks.getByRole("button", { name: `Edit name of the rule: Aisle ${number}` });
  await expect.element(name).toBeInViewport();
}
