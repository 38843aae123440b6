// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

const CAMERA = `\
begin
    SetFrequency /camera/image_raw 10
    SetFrequency /camera/camera_info 3  // small
    SetFrequency /tf 10

    If CheckValue /odom pose_x > 5
    Then
        SetFrequency /odom 4
    EndIf
end
`;
const PROFILE = `\
# The radio of the patrol
budget_kb_per_s = 8000
[topics."/camera/image_raw"]
message_kb = 6220  # measured
[topics."/camera/camera_info"]
message_kb = 0.38
[topics."/tf"]
[topics."/odom"]
`;

test("every finding has a way to go", async () => {
  const clash = CAMERA.replace("EndIf", "EndIf\n    If CheckValue /odom pose_x > 9 Then SetFrequency /odom 2");
  const never = "If (CheckValue /odom pose_x > 5 AND CheckValue /odom speed < -1)";
  await openPatrol(clash.replace("If CheckValue /odom pose_x > 5", never));
  const rows = page.getByRole("list", { name: "Findings" }).getByRole("listitem");
  await expect.element(rows.filter({ hasText: "never below 0" }).first()).toBeVisible();
  // A name leads to what it names.
  const ofAll = rows.filter({ has: page.getByRole("button", { name: "All rules", exact: true }) });
  await expect.poll(() => ofAll.length).toBeGreaterThan(0);
  const ways = page.getByCss("button:not(.link), a:not(.why)");
  expect(ofAll.filter({ hasNot: ways }).length).toBe(0);
});

test("what the optimizer lacks is measured or entered", async () => {
  const ruler = await openPatrol(CAMERA);
  await ruler.openRates();
  await expect.element(page.getByText("do not say all that is needed of")).toBeVisible();
  await page.getByRole("link", { name: "Enter it in patrol.toml" }).click();
  await expect.element(page.getByLabelText("Total bandwidth (KB/s)")).toHaveValue("8000");
});

async function openPatrol(text: string): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "patrol.adirf": text, "patrol.toml": PROFILE } });
  await ruler.open("patrol.adirf");
  await expect.element(page.getByLabelText("Topic parameters")).toHaveValue("patrol.toml");
  return ruler;
}
