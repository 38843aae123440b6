// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { type Locator, page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

const BEFORE = "begin\n    SetFrequency /odom 10\nend\n";
const MINE = BEFORE.replace("10\n", "10\n    SetFrequency /scan 10\n");
const THEIRS = BEFORE.replace("10", "7");
const TABLE = '[topics."/odom"]\nmessage_kb = 0.7\n';

test.each([false, true])("ones own text is kept, where the file is gone: %s", async (isGone) => {
  const ruler = await openChanged();
  const dialog = await meet(ruler, isGone ? null : THEIRS);
  await expect.poll(() => dialog.getByRole("button", { name: "Take theirs" }).length).toBe(isGone ? 0 : 1);
  await dialog.getByRole("button", { name: "Keep mine" }).click();
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  expect(await ruler.saved("plain.adirf")).toBe(MINE);
  expect(await onDisk("plain.adirf")).toBe(MINE);
});

test("who looks at it first loses nothing", async () => {
  const ruler = await openChanged();
  const dialog = await meet(ruler);
  await dialog.getByRole("button", { name: "Look at the difference" }).click();
  await expect.element(dialog.getByRole("figure", { name: "Theirs" })).toHaveTextContent("SetFrequency /odom 7");
  await expect.element(dialog.getByRole("figure", { name: "Yours" })).toHaveTextContent("SetFrequency /odom 10");
  await expect.element(dialog.getByRole("list", { name: "Differences" })).toHaveTextContent("/odom 7 → 10 Hz");
  await dialog.getByRole("button", { name: "Cancel" }).click();
  await expect.element(dialog).not.toBeInTheDocument();
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /");
  await expect.element(await ruler.tool("Save")).toBeEnabled();
  expect(await onDisk("plain.adirf")).toBe(THEIRS);
});

test("what was saved by itself is no conflict", async () => {
  const ruler = await openChanged();
  await ruler.saveOver({ "plain.adirf": MINE });
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  await expect.element(page.getByText("Saved plain.adirf")).toBeVisible();
});

test("a table has the same ways out", async () => {
  const ruler = await openPage("empty", { files: { "wlan.toml": TABLE } });
  await page.getByRole("link", { name: "wlan.toml", exact: true }).click();
  const size = page.getByLabelText("Message size (KB) of /odom");
  await size.fill("0.9");
  await ruler.saveOver({ "wlan.toml": TABLE.replace("0.7", "0.8") });
  const dialog = page.getByRole("dialog", { name: "wlan.toml was changed elsewhere" });
  await dialog.getByRole("button", { name: "Look at the difference" }).click();
  await expect.element(dialog.getByRole("figure", { name: "Yours" })).toHaveTextContent("/odom 0.9");
  await dialog.getByRole("button", { name: "Take theirs" }).click();
  await expect.element(size).toHaveValue("0.8");
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  await ruler.use("Undo");
  await expect.element(size).toHaveValue("0.9");
  await ruler.save();
  expect(await onDisk("wlan.toml")).toBe(TABLE.replace("0.7", "0.9"));
});

/** A file to which somebody added a rate. */
async function openChanged(): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "plain.adirf": BEFORE } });
  await ruler.open("plain.adirf");
  await ruler.button("New rate").click();
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /");
  return ruler;
}

/** Saves it when somebody else wrote `theirs` or removed it; the dialog. */
async function meet(ruler: RulerPage, theirs: string | null = THEIRS): Promise<Locator> {
  await ruler.saveOver({ "plain.adirf": theirs });
  const dialog = page.getByRole("dialog");
  await expect.element(dialog).toHaveTextContent("Nothing that you typed is lost");
  return dialog;
}

/** The text that the server has now. */
async function onDisk(name: string): Promise<string> {
  return (await (await fetch(`api/file?name=${name}`)).json()).text;
}
