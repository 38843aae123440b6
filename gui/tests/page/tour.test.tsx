// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { violations } from "./axe";
import { type Opening, openPage, type RulerPage, resize } from "./ruler_page";

const TITLES = [
  "Rules are blocks",
  "The same as text",
  "What is wrong or doubtful",
  "Try before you trust",
  "Send or download",
] as const;
const RULES = "begin\n    SetFrequency /odom 5\nend\n";

test("beside rules the offer gives way to work and is there again at home", async () => {
  const ruler = await openNew({ files: { "one.adirf": RULES } });
  await ruler.open("one.adirf");
  await ruler.shown(offer());
  await ruler.button("New rule").click();
  await expect.element(offer()).not.toBeInTheDocument();
  await ruler.home();
  await ruler.shown(offer());
});

test.each(["Escape", "No, thanks"])("who does not want it is asked never again: %s", async (way) => {
  const ruler = await openNew();
  await expect.element(ruler.button("Take the tour")).toHaveFocus();
  if (way === "Escape") await commands.press("Escape");
  else await offer().getByRole("button", { name: way }).click();
  await expect.element(offer()).not.toBeInTheDocument();
  await expect.element(page.getByRole("heading", { name: "ADIRF Ruler" })).toHaveFocus();
  await ruler.home();
  await expect.element(offer()).not.toBeInTheDocument();
});

test.each(["Escape", "Skip the tour"])("it is skipped at any step and can be taken again: %s", async (way) => {
  const ruler = await openNew();
  await ruler.button("Take the tour").click();
  // The card moves once to what it points at.
  await ruler.shown(page.getByCss(".tour-ring"));
  await card().getByRole("button", { name: "Next" }).click();
  await ruler.shown(title(TITLES[1]));
  if (way === "Escape") await commands.press("Escape");
  else await ruler.button(way).click();
  await expect.element(card()).not.toBeInTheDocument();
  await page.getByRole("link", { name: "Take the tour" }).click();
  await ruler.shown(title(TITLES[0]));
  await card().getByRole("button", { name: "Next" }).click();
  await card().getByRole("button", { name: "Back" }).click();
  await ruler.shown(title(TITLES[0]));
});

test("the example can be played with but is neither saved nor kept", async () => {
  const ruler = await openNew();
  await ruler.button("Take the tour").click();
  await ruler.change("Edit value: 11", "12");
  await ruler.expectLines("CheckValue /odom pose_x > 12");
  await ruler.use("Save");
  await ruler.shown(page.getByText("The example is not saved"));
  await ruler.button("Skip the tour").click();
  await ruler.shown(page.getByRole("heading", { name: "ADIRF Ruler" }));
  await expect.element(page.getByText("not saved")).not.toBeInTheDocument();
  expect(ruler.network.count("PUT /api/file")).toBe(0);
  expect((await (await fetch("api/project")).json()).files).toEqual([]);
});

test("it leads back to the rules that it was called from", async () => {
  const ruler = await openNew({ files: { "mine.adirf": RULES }, hash: "#/rules/mine.adirf" });
  await ruler.shown(offer());
  await ruler.expectLines("SetFrequency /odom 5");
  await ruler.button("Take the tour").click();
  await ruler.expectLines("Loading Dock");
  await ruler.button("Skip the tour").click();
  await ruler.shown(page.getByRole("heading", { name: "mine.adirf", level: 1 }));
  await ruler.expectLines("SetFrequency /odom 5");
  expect((await (await fetch("api/file?name=mine.adirf")).json()).text).toBe(RULES);
});

test.each([
  [1280, 800],
  [820, 1180],
  [390, 844],
])("each step points at a part that is to be seen: %i, %i", async (width, height) => {
  await resize(width, height);
  const ruler = await openNew({}, false);
  expect(await violations()).toEqual([]);
  await ruler.button("Take the tour").click();
  await ruler.expectLines("Loading Dock");
  for (const [at, name] of TITLES.entries()) {
    await ruler.shown(title(name));
    await expect.poll(isRingBesideCard).toBe(true);
    if (at === 0) expect(await violations()).toEqual([]);
    expect(document.documentElement.scrollWidth).toBeLessThanOrEqual(width);
    await card()
      .getByRole("button", { name: /Next|Finish/ })
      .click();
  }
});

/** The page in a browser that never saw it. */
async function openNew(opening: Opening = {}, isLaptop = true): Promise<RulerPage> {
  if (isLaptop) await resize(1280, 800);
  return openPage("empty", { ...opening, isNew: true });
}

function offer(): Locator {
  return page.getByRole("dialog", { name: "A tour in five steps?" });
}

function card(): Locator {
  return page.getByRole("dialog", { name: "Tour", exact: true });
}

function title(name: string): Locator {
  return card().getByRole("heading", { name });
}

/** Whether the card is whole in the window, and some of what it points at is not below it. */
function isRingBesideCard(): boolean {
  const boxes = [".tour-ring", ".tour-card"].map((each) => document.querySelector(each)?.getBoundingClientRect());
  const [ring, card] = boxes;
  if (!ring || !card) return false;
  const isWhole = card.top >= 0 && card.bottom <= innerHeight && card.left >= 0 && card.right <= innerWidth;
  const isSeen =
    ring.top < card.top - 20 ||
    ring.bottom > card.bottom + 20 ||
    ring.left < card.left - 20 ||
    ring.right > card.right + 20;
  return isWhole && isSeen && ring.height > 20;
}
