// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { openPage, type RulerPage, typedIn } from "./ruler_page";

const RULES = "begin\n    SetFrequency /odom 10\nend\n";
const PROFILE = '# Our radio.\n[topics."/odom"]\nmessage_kb = 0.7\n';

test("the table is still there after a look at the first screen", async () => {
  const ruler = await openPage("empty", { files: { "wlan.toml": PROFILE } });
  const link = page.getByRole("link", { name: "wlan.toml", exact: true });
  await link.click();
  const size = page.getByLabelText("Message size (KB) of /odom");
  await size.fill("0.9");
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await expect.element(page.getByRole("listitem").filter({ hasText: "wlan.toml" })).toHaveTextContent("not saved");
  await link.click();
  await expect.element(size).toHaveValue("0.9");
  await ruler.save();
  expect(await ruler.saved("wlan.toml")).toBe(PROFILE.replace("0.7", "0.9"));
});

test("a new table is listed before it is a file", async () => {
  await openPage("empty", { files: { "plain.adirf": RULES, "other.adirf": RULES } });
  await page.getByRole("link", { name: "Topics", exact: true }).click();
  const topic = page.getByLabelText("Topic of row 1");
  await topic.fill("/odom");
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await page.getByRole("link", { name: "profile.toml", exact: true }).click();
  await expect.element(topic).toHaveValue("/odom");
});

test("no block is added to a text that cannot be read", async () => {
  const { ruler } = await openRules();
  await typeBelow(ruler, "SetFrequenzy");
  await expect.element(page.getByText("The text has an error")).toBeVisible();
  for (const name of ["New rate", "New rule"]) await expect.element(ruler.button(name)).toBeDisabled();
});

test("a save names the blocks that it leaves out", async () => {
  const { ruler } = await openRules();
  await page.getByRole("treeitem", { name: "Checks" }).click();
  const listed = page.getByRole("listbox", { name: "Checks blocks" });
  await ruler.drag(listed.getByRole("option").first(), page.getByRole("treeitem", { name: "Actions" }), 400, 200);
  await ruler.button("New rate").click();
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /");
  await ruler.save();
  const said = page.getByText("Saved plain.adirf without 1 block that is not in the text");
  await expect.element(said).toBeVisible();
});

test("a change of the blocks is not called saved before it is in the text", async () => {
  const { ruler } = await openRules();
  await expect.element(headerNote()).toHaveTextContent(/^saved$/);
  const release = ruler.network.hold("POST /api/edit");
  const asked = ruler.network.count("POST /api/edit");
  await ruler.change("Edit rate: 10", "7");
  await expect.poll(() => ruler.network.count("POST /api/edit")).toBeGreaterThan(asked);
  await expect.element(headerNote()).toHaveTextContent(/^not saved$/);
  await ruler.use("Save");
  await expect.element(headerNote()).toHaveTextContent(/^not saved$/);
  expect(ruler.network.count("PUT /api/file")).toBe(0);
  release();
  await expect.element(headerNote()).toHaveTextContent(/^saved$/);
  expect(await ruler.saved("plain.adirf")).toBe(RULES.replace("10", "7"));
});

test("a save holds what stands in an open field", async () => {
  const { ruler } = await openRules();
  await (await ruler.field("Edit rate: 10")).click();
  await commands.press("Control+a");
  await commands.type("7");
  await expect.element(headerNote()).toHaveTextContent(/^not saved$/);
  await commands.press("Control+s");
  await expect.element(page.getByText("Saved plain.adirf", { exact: true })).toBeVisible();
  expect(await ruler.saved("plain.adirf")).toBe(RULES.replace("10", "7"));
  await (await ruler.field("Edit rate: 7")).click();
  await commands.press("Control+a");
  await commands.type("often");
  await commands.press("Control+s");
  await expect.element(page.getByText("Saved plain.adirf without what is being typed")).toBeVisible();
  await expect.element(headerNote()).toHaveTextContent(/^not saved$/);
  await expect.poll(() => typedIn(page.getByRole("combobox", { name: "rate", exact: true }))).toBe("often");
});

function headerNote(): Locator {
  return page.getByRole("banner").getByText("saved");
}

/** Opens a file with one rate; gives the rates among its blocks, too. */
async function openRules(): Promise<{ ruler: RulerPage; rates: Locator }> {
  const ruler = await openPage("empty", { files: { "plain.adirf": RULES } });
  await ruler.open("plain.adirf");
  const rates = ruler.blocks.getByRole("button", { name: "Edit topic to send" });
  await expect.poll(() => rates.length).toBe(1);
  return { ruler, rates };
}

async function typeBelow(ruler: RulerPage, line: string): Promise<void> {
  await ruler.text.getByText("SetFrequency").first().click();
  await commands.press("End", "Enter");
  await commands.type(line);
}
