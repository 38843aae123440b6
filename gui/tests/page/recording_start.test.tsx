// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { openPage } from "./ruler_page";

test("only what is wanted is made", async () => {
  const ruler = await openPage("monday");
  await page.getByRole("link", { name: "Recordings" }).click();
  await ruler.button("New rules from monday").click();
  const dialog = page.getByRole("dialog", { name: "Start from monday" });
  await dialog.getByLabelText("Measure sizes").click();
  await expect.element(dialog.getByLabelText("Measure sizes")).not.toBeChecked();
  await dialog.getByLabelText("Show the path").click();
  await expect.element(dialog.getByLabelText("Show the path")).not.toBeChecked();
  await dialog.getByRole("textbox", { name: "Name" }).fill("tuesday");
  await dialog.getByRole("button", { name: "Create" }).click();
  await ruler.expectLines("SetFrequency /odom Full");
  const made = ruler.network.asked.filter(({ ask }) => ask === "PUT /api/file");
  expect(made).toEqual([{ ask: "PUT /api/file", body: expect.objectContaining({ name: "tuesday.adirf" }) }]);
});
