// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

/** The thesis's Figure 6.6. */
const FIGURE = `\
begin
    If (
        CheckValue /odom pose_x > 11
        AND CheckValue /odom pose_x < 15
        AND CheckValue /odom pose_y > 7
        AND CheckValue /odom pose_y < 11
    )
    Then
        SetFrequency /imu Competitive
        SetFrequency /camera/image_raw Excessive
    EndIf
end
`;
const INSPECTION = {
  "inspection.adirf": `\
begin
    SetFrequency /odom 10
    Rule "Inspection"
    If CheckValue /odom speed < -1
    Then
        SetFrequency /tf 4
    EndIf
end
`,
  "radio.toml": 'budget_kb_per_s = 100\n[topics."/odom"]\nmessage_kb = 1\n',
};

test("the rule is built with the keyboard alone", async () => {
  const ruler = await openPage("empty");
  await ruler.walk("Tab", "New Rule File");
  await commands.press("Enter");
  await expect.element(page.getByLabelText("Name")).toHaveFocus();
  await commands.type("shelf");
  await commands.press("Enter");
  await expect.element(ruler.button("New rule")).toBeEnabled();
  await ruler.walk("Tab", "New rule");
  await commands.press("Enter");
  await ruler.expectLines("CheckValue /odom pose_x > 0", "SetFrequency /odom 10");

  await commands.press("Escape");
  await edit(ruler, "Edit value", "11");
  for (const value of ["15", "7", "11"]) {
    await ruler.walk("ArrowUp", "Begin stack, rule");
    await ruler.walk("ArrowRight", "Add check");
    await commands.press("Enter");
    await awaitLabel((label) => label.startsWith("value"));
    await ruler.typeValue(value);
    await awaitValue(value);
  }
  await ruler.walk("ArrowDown", "set frequency of");
  await edit(ruler, "Edit topic to send", "/imu");
  await edit(ruler, "Edit rate", "Competitive");
  await ruler.walk("ArrowUp", "Add rate");
  await commands.press("Enter");
  await awaitLabel((label) => label.startsWith("topic to send"));
  await ruler.typeValue("/camera/image_raw");
  await awaitValue("/camera/image_raw");
  await edit(ruler, "Edit rate", "Excessive");
  await ruler.expectLines("SetFrequency /camera/image_raw Excessive");
  await commands.press("Control+s");
  await ruler.shown(page.getByText("Saved shelf.adirf"));
  expect(await ruler.saved("shelf.adirf")).toBe(FIGURE);
});

test("half a topic is not sent when an earlier edit is answered meanwhile", async () => {
  const ruler = await openPage("empty");
  await ruler.button("New Rule File").click();
  await page.getByLabelText("Name").fill("shelf");
  await ruler.button("Create").click();
  await ruler.button("New rule").click();
  await ruler.expectLines("CheckValue /odom pose_x > 0", "SetFrequency /odom 10");
  const release = await holdEdit(ruler, () => ruler.change("Edit rate", "Competitive"));
  await (await ruler.field("Add rate")).click();
  await awaitLabel((label) => label.startsWith("topic to send"));
  await commands.press("Control+a");
  await commands.type("/");
  const answered = ruler.network.answered("POST /api/edit");
  release();
  await answered;
  await commands.type("camera/image_raw");
  await commands.press("Enter");
  await ruler.expectLines("SetFrequency /odom Competitive", "SetFrequency /camera/image_raw Competitive");
});

test("blocks that are left still bring their edits into the text", async () => {
  const ruler = await openRates("a", "b", "c");
  const release = await holdEdit(ruler, () => retype(ruler, "a", "/in_flight"));
  // The answer is awaited, so this one waits in the blocks, and the next one is typed when they are left.
  await retype(ruler, "b", "/queued");
  await (await ruler.field("Edit topic to send: /c")).click();
  await commands.press("Control+a");
  await commands.type("/typed");
  location.hash = "#/";
  await ruler.shown(ruler.button("New Rule File"));
  const answered = ruler.network.answered("POST /api/edit");
  release();
  await answered;
  await ruler.open("left.adirf");
  await ruler.expectLines("SetFrequency /in_flight 5", "SetFrequency /queued 5", "SetFrequency /typed 5");
});

test.each(["POST /api/document", "POST /api/profile/for"])(
  "rules are shown once they are read with their profile: %s",
  async (route) => {
    const ruler = await openPage("empty", { files: INSPECTION });
    const release = ruler.network.hold(route);
    await page.getByRole("link", { name: "inspection.adirf", exact: true }).click();
    await expect.poll(() => ruler.network.count(route)).toBeGreaterThan(0);
    await ruler.shown(page.getByText("Opening inspection.adirf …"));
    release();
    await ruler.shown(ruler.pane("Findings (3)"));
  },
);

test("rules that nobody checked are not called good", async () => {
  const ruler = await openPage("empty", { files: INSPECTION });
  ruler.network.replace("POST /api/document", { status: 500, json: { error: { message: "the disk is gone" } } });
  await page.getByRole("link", { name: "inspection.adirf", exact: true }).click();
  await ruler.expectLines("Inspection");
  await ruler.shown(page.getByText("Checking the rules …"));
  await ruler.shown(ruler.pane("Findings (…)"));
  ruler.network.replace("POST /api/document", null);
  await ruler.text.getByText("Inspection").click();
  await commands.press("End");
  await commands.type(" ");
  await ruler.shown(ruler.pane("Findings (3)"));
});

async function openRates(...topics: string[]): Promise<RulerPage> {
  const rates = topics.map((topic) => `    SetFrequency /${topic} 5\n`);
  const ruler = await openPage("empty", { files: { "left.adirf": `begin\n${rates.join("")}end\n` } });
  await ruler.open("left.adirf");
  return ruler;
}

/** Holds the next edit, which `act` asks for; the returned function lets it go. */
async function holdEdit(ruler: RulerPage, act: () => Promise<void>): Promise<() => void> {
  const asked = ruler.network.count("POST /api/edit");
  const release = ruler.network.hold("POST /api/edit");
  await act();
  await expect.poll(() => ruler.network.count("POST /api/edit")).toBeGreaterThan(asked);
  return release;
}

async function retype(ruler: RulerPage, topic: string, instead: string): Promise<void> {
  await (await ruler.field(`Edit topic to send: /${topic}`)).click();
  await ruler.typeValue(instead);
}

/** Waits until the focus is on something with such a label. */
async function awaitLabel(isIt: (label: string) => boolean): Promise<void> {
  await expect.poll(() => isIt(document.activeElement?.getAttribute("aria-label") ?? "")).toBe(true);
}

function awaitValue(value: string): Promise<void> {
  return awaitLabel((label) => label.endsWith(`: ${value}`));
}

async function edit(ruler: RulerPage, label: string, value: string): Promise<void> {
  await ruler.walk("ArrowRight", label);
  await commands.press("Enter");
  await ruler.typeValue(value);
  await awaitValue(value);
}
