// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page, userEvent } from "vitest/browser";
import { openPage } from "./ruler_page";

const AISLE = `\
begin
    SetFrequency /front/scan 5
    SetFrequency /lift 2
end
`;

async function choosePreset(title: RegExp) {
  await page.getByRole("button", { name: "From a preset" }).click();
  await page.getByRole("radio", { name: title }).click();
  await page.getByRole("button", { name: "Fill" }).click();
}

test("a preset fills what nobody gave, and says that it is not measured until somebody types it", async () => {
  const ruler = await openPage("empty", { files: { "aisle.adirf": AISLE } });
  await page.getByRole("link", { name: "Topics", exact: true }).click();
  await page.getByLabelText("Message size (KB) of /lift").fill("0.5");
  await choosePreset(/^Lidar:/);
  await expect.element(page.getByLabelText("Source (Hz) of /front/scan")).toHaveValue("40");
  await expect.element(page.getByLabelText("Message size (KB) of /lift")).toHaveValue("0.5");
  await expect.element(page.getByLabelText("Topic of row 3")).not.toBeInTheDocument();
  await expect.element(page.getByRole("row", { name: "/front/scan" })).toHaveTextContent("not measured");
  expect(page.getByText("not measured", { exact: true }).length).toBe(1);
  await ruler.save();
  expect(await ruler.saved("aisle.toml")).toContain("measured = false");

  await page.getByLabelText("Source (Hz) of /front/scan").fill("20");
  await expect.element(page.getByText("not measured", { exact: true })).not.toBeInTheDocument();
  await ruler.save();
  expect(await ruler.saved("aisle.toml")).not.toContain("measured = false");
});

test("a preset of a robot makes a table by the keyboard alone, and undo takes it back", async () => {
  const ruler = await openPage("empty");
  await page.getByRole("link", { name: "Topics", exact: true }).click();
  await expect.element(page.getByLabelText("Topic of row 1")).toBeVisible();
  (await page.getByRole("button", { name: "From a preset" }).findElement()).focus();
  await userEvent.keyboard("{Enter}");
  await expect.element(page.getByRole("radio", { name: /^Camera/ })).toHaveFocus();
  await userEvent.keyboard("{ArrowUp}{ArrowUp}{Enter}");
  await expect
    .element(page.getByLabelText("Message size (KB) of /camera/image_raw", { exact: true }))
    .toHaveValue("921.652");
  expect(page.getByText("not measured", { exact: true }).length).toBe(10);
  await ruler.save();
  // What nobody types comes along: what follows what, and where the numbers are from.
  const saved = await ruler.saved("profile.toml");
  expect(saved).toContain('paced_with = "/camera/image_raw"');
  expect(saved).toContain("# TurtleBot3: a real one");
  expect(saved).not.toContain("budget_kb_per_s");
  await ruler.use("Undo");
  await expect.element(page.getByLabelText("Topic of row 2")).not.toBeInTheDocument();
});

test("what a recording says takes the place of a preset, and the mark goes", async () => {
  await openPage("monday");
  await page.getByRole("link", { name: "Topics", exact: true }).click();
  await choosePreset(/^TurtleBot3:/);
  await expect.element(page.getByRole("row", { name: "/odom" })).toHaveTextContent("not measured");
  await page.getByLabelText("Measure in").selectOptions("monday");
  await expect.element(page.getByText("not measured", { exact: true })).not.toBeInTheDocument();
});
