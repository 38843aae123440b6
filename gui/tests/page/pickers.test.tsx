// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, onTestFinished, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { boxOf, openPage, type RulerPage, resize } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 10

    Rule "Dock"
    If CheckValue /odom pose_x > 5
    Then
        SetFrequency /odom 4
    EndIf
end
`;
const PROFILE = `\
[topics."/odom"]
source_hz = 20
tiers_hz = [1, 2, 5, 10, 15, 20]
`;
const NAMED_KEYS = ["Enter", "Tab", "Escape", "End", "ArrowUp"];

test.each([
  ["/im", "Enter", "/imu"],
  ["/im", "Tab", "/imu"],
  ["/camera/image_raw/comp", "Enter", "/camera/image_raw/compressed"],
  ["/camera/image_raw/comp", "Tab", "/camera/image_raw/compressed"],
])("of %s %s makes the one topic that begins so", async (typed, key, topic) => {
  const ruler = await openDock();
  await (await ruler.field("Edit topic to send")).click();
  await commands.type(typed);
  await expect.element(option(topic)).toHaveAttribute("aria-selected", "true");
  await commands.press(key);
  await ruler.expectLines(`SetFrequency ${topic} 4`);
});

test("a name that neither robot, recording nor profile has is marked", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit topic to send")).click();
  await commands.type("/sacn");
  await ruler.shown(page.getByText("“/sacn” is kept as typed: not on the robot, in the recording or the profile"));
  await commands.press("Enter");
  await ruler.expectLines("SetFrequency /sacn 4");
  await (await ruler.field("Edit topic to send: /sacn")).click();
  await expect.element(option("/imu")).toHaveTextContent("not on the robot, in the recording or the profile");
  await expect.element(option("/odom")).toHaveTextContent("20 Hz in dock.toml");
});

test("topics of the recording are offered", async () => {
  const ruler = await openPage("monday", { files: { "dock.adirf": RULES } });
  await ruler.open("dock.adirf");
  await (await ruler.field("Edit topic to send")).click();
  await expect.element(option("/map_name")).toHaveTextContent("in the recording");
});

test("a name that nobody knows is kept as typed", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit topic to send")).click();
  await keys("/odo", "ArrowUp");
  const half = page.getByRole("option", { name: "/odo as typed" });
  await expect.element(half).toHaveAttribute("aria-selected", "true");
  await commands.press("Enter");
  await ruler.expectLines("SetFrequency /odo 4");
  await (await ruler.field("Edit topic to send: /odo")).click();
  await keys("cam", "ArrowUp");
  const typed = page.getByRole("option", { name: "cam as typed" });
  await expect.element(typed).toHaveAttribute("aria-selected", "true");
  await commands.press("Enter");
  await ruler.expectLines("SetFrequency cam 4");
});

test("a property says what it means and a level its hz", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit property")).click();
  await keys("yaw_r");
  await expect.element(option("yaw_rate")).toHaveTextContent("signed turning rate");
  await expect.element(option("yaw_rate")).toHaveTextContent("rad/s");
  await commands.press("Enter");
  await ruler.expectLines("CheckValue /odom yaw_rate > 5");
  await (await ruler.field("Edit rate: 4")).click();
  await expect.element(option("Full")).toHaveTextContent("every message");
  await expect.element(option("Desirable")).toHaveTextContent("5 – 10 Hz");
  await option("Desirable").click();
  await ruler.expectLines("SetFrequency /odom Desirable");
});

test("half a level is what the list points at also when somebody clicks elsewhere", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit rate: 4")).click();
  await keys("exc");
  await expect.element(option("Excessive")).toHaveAttribute("aria-selected", "true");
  await page.getByRole("heading", { level: 1 }).click();
  await ruler.expectLines("SetFrequency /odom Excessive");
  await (await ruler.field("Edit rate: Excessive")).click();
  await keys("mar", "Escape");
  await ruler.shown(ruler.blocks.getByRole("button", { name: "Edit rate: Excessive" }));
});

test("topics to record are picked one after the other", async () => {
  const ruler = await openDock();
  await (await ruler.field("Add recording")).click();
  await keys("near miss", "Tab");
  await keys("odom", "Enter");
  await ruler.expectLines('Record "near miss" /odom Before');
  await (await ruler.field("Edit topics to record")).click();
  await keys("End", " imu", "Enter");
  await ruler.expectLines('Record "near miss" /odom /imu Before');
});

test("a number with a comma is one number or is asked about", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit value: 5")).click();
  await keys("0,5", "Enter");
  await ruler.expectLines("CheckValue /odom pose_x > 0.5");
  await (await ruler.field("Edit value: 0.5")).click();
  await keys("1,000", "Enter");
  await ruler.shown(page.getByText("“1,000” can mean 1 or 1000: write 1 or 1000"));
  await ruler.typeValue("1000");
  await ruler.expectLines("CheckValue /odom pose_x > 1000");
});

test.each([1280, 820, 390])("a list is whole on every screen: %i", async (width) => {
  await resize(width, 800);
  const ruler = await openDock();
  // The text of the selected rule would stand beside the list.
  await ruler.openPane("Map");
  await (await ruler.field("Edit topic to send")).click();
  // It is put where there is room for it once it is filled.
  await expect
    .poll(async () => {
      const { left, top, right, bottom } = await boxOf(page.getByRole("listbox", { name: "topic to send" }));
      return left >= 0 && top >= 0 && right <= width && bottom <= 800;
    })
    .toBe(true);
});

test("an open list lets the page rest", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit topic to send")).click();
  await ruler.shown(option("/odom"));
  const ask = window.requestAnimationFrame;
  onTestFinished(() => {
    window.requestAnimationFrame = ask;
  });
  let asked = 0;
  window.requestAnimationFrame = (act) => {
    asked++;
    return ask.call(window, act);
  };
  // Findings that come later are drawn on the blocks first.
  await expect
    .poll(async () => {
      asked = 0;
      for (let count = 0; count < 30; count++) await new Promise((next) => ask.call(window, next));
      return asked;
    })
    .toBe(0);
});

async function openDock(): Promise<RulerPage> {
  const files = { "dock.adirf": RULES, "dock.toml": PROFILE, "other.adirf": "begin\n    SetFrequency /imu 2\nend\n" };
  const ruler = await openPage("empty", { files });
  await ruler.open("dock.adirf");
  await expect.element(page.getByLabelText("Topic parameters")).toHaveValue("dock.toml");
  return ruler;
}

function option(word: string): Locator {
  return page.getByRole("option").filter({ has: page.getByCss(".word").getByText(word, { exact: true }) });
}

/** Types words, and presses keys with names. */
async function keys(...typed: string[]): Promise<void> {
  for (const each of typed) await (NAMED_KEYS.includes(each) ? commands.press(each) : commands.type(each));
}
