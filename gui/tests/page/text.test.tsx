// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { boxOf, openPage, type RulerPage } from "./ruler_page";

const HOSTILE_LINES = [
  "// <img src=x onerror=alert(1)>",
  "begin",
  '  Rule "<script>alert(2)</script>"',
  "  If (CheckValue",
  "/odom  pose_x>1) Then",
  "  SetFrequency /odom 2 //ä 🤖",
  "end",
];
const SPEED = `\
begin
    SetFrequency /scan 3

    Rule "Backwards"
    If CheckValue /odom speed < -1
    Then
        SetFrequency /scan 4
    EndIf
end
`;

test("blocks that go together are one request and one step back", async () => {
  const rules = "begin\n    SetFrequency /a 1\n    SetFrequency /b 2\n    SetFrequency /c 3\nend\n";
  const ruler = await openPage("empty", { files: { "stack.adirf": rules } });
  await ruler.open("stack.adirf");
  await (await ruler.field("Edit topic to send: /b")).hover();
  const { left, top } = await boxOf(page.getByRole("treeitem", { name: "Rules" }));
  await commands.mouseDown();
  await commands.mouseMove(left + 10, top + 10, 12);
  await commands.mouseUp();
  await expect.element(ruler.text).not.toHaveTextContent("/c");
  expect(ruler.network.count("POST /api/edit")).toBe(1);
  await ruler.save();
  expect(await ruler.saved("stack.adirf")).toBe("begin\n    SetFrequency /a 1\nend\n");
  await ruler.use("Undo");
  await expect.element(ruler.text).toHaveTextContent("SetFrequency /c 3");
  await ruler.save();
  expect(await ruler.saved("stack.adirf")).toBe(rules);
});

test.each([
  ["3,5", "3.5"],
  ["−2", "-2"],
])("a threshold is what was typed: %s", async (typed, value) => {
  const ruler = await typeThreshold(typed);
  await ruler.shown(ruler.blocks.getByRole("button", { name: `Edit value: ${value}`, exact: true }));
  await ruler.expectLines(`speed < ${value}`, "Then");
});

test.each(["1.000,5", "x"])("what is no number is said and the threshold stays: %s", async (typed) => {
  const ruler = await typeThreshold(typed);
  await ruler.shown(page.getByText(`“${typed}”`));
  await commands.press("Escape");
  await ruler.shown(ruler.blocks.getByRole("button", { name: "Edit value: 1", exact: true }));
  await ruler.expectLines("speed < 1", "Then");
});

test.each(["\n", "\r\n"])("line ends and hostile words stay what they are: %j", async (lineEnd) => {
  const text = HOSTILE_LINES.join(lineEnd);
  const ruler = await openPage("empty", { files: { "odd.adirf": text } });
  await ruler.open("odd.adirf");
  await (await ruler.field("Edit value: 1")).click();
  await ruler.typeValue("3");
  await ruler.expectLines("pose_x>3");
  await ruler.save();
  expect(await ruler.saved("odd.adirf")).toBe(text.replace("pose_x>1", "pose_x>3"));
});

test("a mark stays on its words when a block is added above", async () => {
  const ruler = await openSpeed();
  const marked = ruler.text.getByCss(".cm-lintRange-warning");
  const words = () => marked.elements().map((each: Element) => each.textContent);
  await expect.poll(words).toEqual(["CheckValue /odom speed < -1"]);
  await ruler.button("New rate").click();
  await ruler.expectLines("SetFrequency /odom 10", "If CheckValue");
  await expect.poll(words).toEqual(["CheckValue /odom speed < -1"]);
  await ruler.use("Undo");
  await expect.poll(words).toEqual(["CheckValue /odom speed < -1"]);
});

test("a block drawn once its text is right can be edited", async () => {
  const ruler = await openSpeed();
  await ruler.field("Edit topic to send: /scan");
  await replaceInText(ruler, "SetFrequency /scan 3", "SetFrequency /scan");
  await ruler.shown(page.getByText("the blocks show how it was before"));
  const topics = ruler.blocks.getByRole("button", { name: "Edit topic to send" });
  await expect.poll(() => topics.length).toBe(0);
  await commands.insertText(" 3 SetFrequency /imu 4");
  const imu = ruler.blocks.getByRole("button", { name: "Edit topic to send: /imu" });
  await expect.poll(() => imu.length).toBe(1);
  await expect.poll(() => ruler.blocks.getByRole("button", { name: "Remove this rate" }).length).toBe(3);
});

test("completions grow when more topics are known while they are open", async () => {
  const release = (await typeWhileTopicsWait("SetFrequency /gripper 3\nSetFrequency /gr")).release;
  await commands.press("Control+Space");
  release();
  await expect.element(page.getByRole("option", { name: "/gripper" })).toBeVisible();
});

test("the list of a field grows when more topics are known while it is open", async () => {
  const { ruler, release } = await typeWhileTopicsWait("SetFrequency /gripper 3");
  await (await ruler.field("Edit topic to send: /scan")).click();
  const listed = page.getByRole("listbox", { name: "topic to send" }).getByRole("option");
  await expect.poll(() => listed.length).toBeGreaterThan(0);
  const gripper = listed.filter({ hasText: "/gripper" });
  expect(gripper.length).toBe(0);
  release();
  await expect.poll(() => gripper.length).toBe(1);
});

async function openSpeed(text = SPEED): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "speed.adirf": text } });
  await ruler.open("speed.adirf");
  return ruler;
}

async function typeThreshold(typed: string): Promise<RulerPage> {
  const ruler = await openSpeed(SPEED.replace("-1", "1"));
  await (await ruler.field("Edit value: 1")).click();
  await commands.press("Control+a", "Delete");
  await commands.insertText(typed);
  await commands.press("Enter");
  return ruler;
}

/** Types instead of a line; `release` lets the page know the topics of the text. */
async function typeWhileTopicsWait(typed: string): Promise<{ ruler: RulerPage; release: () => void }> {
  const ruler = await openSpeed();
  await ruler.field("Edit topic to send: /scan");
  const release = ruler.network.hold("POST /api/vocabulary");
  const asked = ruler.network.count("POST /api/vocabulary");
  await replaceInText(ruler, "SetFrequency /scan 3", typed);
  await expect.poll(() => ruler.network.count("POST /api/vocabulary")).toBeGreaterThan(asked);
  return { ruler, release };
}

/** Clicks into the line, selects it and puts other text there at once: no part of it is checked. */
async function replaceInText(ruler: RulerPage, old: string, instead: string): Promise<void> {
  await ruler.text.getByText(old, { exact: true }).first().click();
  await commands.press("End", "Shift+Home");
  await commands.insertText(instead);
}
