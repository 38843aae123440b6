// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { robotOf } from "../state/told_robots";
import { openPage } from "./ruler_page";

test("a project without incidents says how to get some", async () => {
  await openPage("monday");
  await page.getByRole("link", { name: "Incidents", exact: true }).click();
  await expect.element(page.getByText("0 incidents")).toBeVisible();
  await expect.element(page.getByRole("main")).toHaveTextContent("To get one");
});

test("incidents on the disk of a robot that is heard over ROS are said, with how to get them", async () => {
  const ruler = await openPage("monday");
  const robots = [{ ...robotOf("/ada"), recorded: 5 }, robotOf("/bob")];
  ruler.network.greeting = [...ruler.network.greeting.slice(0, 1), { kind: "robots", problem: null, robots }];
  await page.getByRole("link", { name: "Incidents", exact: true }).click();
  const disks = page.getByRole("region", { name: "On robots" });
  await expect.element(disks).toHaveTextContent("5 incidents are on the disk of /ada.");
  await expect.element(disks).toHaveTextContent("testudo ruler --connect");
  await expect.element(disks).not.toHaveTextContent("bob");
});
