// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { openPage, type RulerPage, resize, typedIn } from "./ruler_page";

const WIDTH_PX = 1280;
const LAST_TOPIC = "/warehouse_robot_59/camera_front_left/depth_registered/image_rect_raw";
/** What may be wider than its place: it is drawn, or scrolls by itself. */
const DRAWN = "svg, .blocks-host, .text-host, .visually-hidden";

const PAGES: Record<string, (ruler: RulerPage) => Promise<void>> = {
  async optimizer(ruler) {
    await ruler.open("sixty.adirf");
    await ruler.openRates();
    await expect.element(page.getByText("Not everything fits")).toBeVisible();
  },
  rules: openRules,
  async findings(ruler) {
    await openRules(ruler);
    await page.getByLabelText("Topic parameters").selectOptions("none");
    const findings = page.getByRole("list", { name: "Findings" }).getByRole("listitem");
    await expect.poll(() => findings.length).toBeGreaterThan(0);
  },
  async parameters() {
    await page.getByRole("link", { name: "sixty.toml", exact: true }).click();
    const last = page.getByRole("textbox", { name: "Topic" }).nth(59);
    await expect.poll(() => last.length > 0 && typedIn(last)).toBe(LAST_TOPIC);
  },
  async search(ruler) {
    await openRules(ruler);
    await page.getByRole("combobox", { name: "Find a rule" }).fill("image");
    await expect.element(page.getByRole("option").first()).toBeVisible();
  },
};

test.each(Object.keys(PAGES))("sixty topics stay on the screen: %s", async (name) => {
  await resize(WIDTH_PX, 800);
  const ruler = await openPage("sixty");
  await PAGES[name]?.(ruler);
  expect(document.documentElement.scrollWidth).toBeLessThanOrEqual(innerWidth);
  expect(beyond()).toEqual([]);
});

async function openRules(ruler: RulerPage): Promise<void> {
  await ruler.open("sixty.adirf");
  await expect.element(page.getByLabelText("Topic parameters")).toHaveValue("sixty.toml");
  await expect.element(page.getByText("No findings: the rules can be used as they are.")).toBeVisible();
}

/** What sticks out of its own box without a scroll bar, or is cut off by the window. */
function beyond(): string[] {
  const isCut = (each: Element) => {
    for (let box = each.parentElement; box !== null; box = box.parentElement)
      if (["auto", "scroll", "hidden"].includes(getComputedStyle(box).overflowX)) return false;
    return true;
  };
  return [...document.querySelectorAll("main *, .dock *")]
    .filter((each) => each.closest(DRAWN) === null)
    .filter((each) => each.getBoundingClientRect().width > 0)
    .filter((each) => each.getBoundingClientRect().right > innerWidth + 1)
    .filter(isCut)
    .map((each) => each.outerHTML.slice(0, 120));
}
