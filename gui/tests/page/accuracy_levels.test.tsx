// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { type Locator, page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

const PROFILE = `\
[topics."/odom"]
message_kb = 0.7

[topics."/scan"]
type = "sensor_msgs/msg/LaserScan"
`;
const TIERS = "tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]  # our arm's reach\n";
const NEEDS = "tiers_m_need_hz = [0.6, 1, 2, 4, 8, 12]\n";

test("keys keep the order and without a recording the needs go with a word", async () => {
  const ruler = await openAccuracies(PROFILE.replace("0.7\n", `0.7\n${TIERS}${NEEDS}`));
  const marginal = line("Marginal");
  await expect.element(need("Marginal")).toHaveTextContent("the profile");
  await ruler.press(marginal, "ArrowRight");
  await expect.element(marginal).toHaveAttribute("aria-valuetext", "0.21 m");
  await expect.element(page.getByText("What the levels needed was removed")).toBeVisible();
  await ruler.press(marginal, "End");
  await expect.element(marginal).toHaveAttribute("aria-valuetext", "0.5 m");
  await ruler.press(marginal, "ArrowRight");
  await expect.element(page.getByText("Marginal stops at Unacceptable (0.5 m): it cannot lie above")).toBeVisible();
  for (let step = 0; step < 3; step++) await ruler.use("Undo");
  await expect.element(marginal).toHaveAttribute("aria-valuetext", "0.2 m");
  await expect.element(need("Marginal")).toHaveTextContent("the profile");
  await ruler.press(marginal, "ArrowLeft");
  await ruler.use("Save");
  await expect.element(page.getByText("Saved radio.toml")).toBeVisible();
  expect(await ruler.saved("radio.toml")).toBe(PROFILE.replace("0.7\n", `0.7\n${TIERS.replace("0.2", "0.19")}`));
});

test("a topic without a position has levels of rates only", async () => {
  await openAccuracies(PROFILE);
  await page.getByRole("combobox", { name: "Topic" }).selectOptions("/scan");
  await expect.element(page.getByRole("combobox", { name: "Levels of" })).not.toBeInTheDocument();
  await expect.element(page.getByText("/scan has no six levels yet.")).toBeVisible();
});

async function openAccuracies(profile: string): Promise<RulerPage> {
  const ruler = await openPage("monday", { files: { "radio.toml": profile } });
  await page.getByRole("link", { name: "radio.toml" }).click();
  await page.getByRole("combobox", { name: "Levels of" }).selectOptions("Accuracy of position");
  return ruler;
}

function line(level: string): Locator {
  return page.getByRole("slider", { name: `${level} level of /odom position (m)`, exact: true });
}

function need(level: string): Locator {
  return page.getByRole("table", { name: "What the levels need" }).getByRole("row", { name: level });
}
