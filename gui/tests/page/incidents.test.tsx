// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { openPage } from "./ruler_page";

test("a project without incidents says how to get some", async () => {
  const ruler = await openPage("monday");
  await ruler.button("Look at Incidents").click();
  await expect.element(page.getByText("0 incidents")).toBeVisible();
  await expect.element(page.getByRole("main")).toHaveTextContent("To get one");
});
