// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

const PROFILE = `\
budget_kb_per_s = 3000
[topics."/camera"]
message_kb = 500
source_hz = 30
tiers_hz = [2, 4, 6, 8, 10, 15]
[topics."/odom"]
message_kb = 1
source_hz = 30
tiers_hz = [2, 4, 6, 8, 10, 15]
`;
const rows = () => page.getByRole("list", { name: "Findings" }).getByRole("listitem");
const row = (words: string) => rows().filter({ hasText: words });

test("what does not fit, and topics that nobody knows, are findings", async () => {
  const ruler = await openRules(`\
begin
    SetFrequency /odom 10
    SetFrequency /camera Excessive

    Rule "Close"
    If CheckValue /odmo pose_x > 1
    Then
        SetFrequency /sacn 3
    EndIf
end
`);
  await ruler.shown(row("/sacn").first());
  await ruler.shown(row("neither robot, recording nor profile has /sacn"));
  await ruler.text.fill("begin\n    SetFrequency /odom 10\n    SetFrequency /camera Excessive\nend\n");
  await expect.element(row("Error")).toHaveTextContent("more than the budget");
  await expect.element(rows().first()).toHaveTextContent("Error");
});

test("a misspelled name is found in the list and on its very block", async () => {
  const ruler = await openRules(
    `\
begin
    SetFrequency /sacn 5

    Rule "Close"
    If CheckValue /odmo pose_x > 1
    Then
        SetFrequency /odom 3
    EndIf
end
`,
    `${PROFILE}[topics."/scan"]\nmessage_kb = 1\nsource_hz = 10\ntiers_hz = [1, 2, 3, 4, 5, 8]\n`,
  );
  // Of the smallest block around each mark: no whole rule.
  const marked = () => [...document.querySelectorAll(".finding-mark")].map((mark) => mark.parentElement?.textContent);
  for (const [wrong, right] of [
    ["/sacn", "/scan"],
    ["/odmo", "/odom"],
  ] as const) {
    await ruler.shown(row(wrong).filter({ hasText: right }).first());
    await expect.poll(() => marked().some((words) => words?.includes(wrong) && !words.includes("IF"))).toBe(true);
  }
});

test("rules that break the budget together are found, by their names, and limited to warnings", async () => {
  const ruler = await openRules(`\
begin
    SetFrequency /odom 10
    SetFrequency /camera 1

    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /camera 8
    EndIf

    Rule "Low"
    If CheckValue /odom pose_y > 1
    Then
        SetFrequency /odom 10
    EndIf
end
`);
  const over = row("more than the budget").first();
  await expect.element(over).toHaveTextContent("“if /odom pose_x > 1”");
  await expect.element(over).not.toHaveTextContent(/\bline \d/);
  await expect.element(over.getByRole("button").first()).toHaveTextContent("Rule if /odom pose_x > 1");
  const bar = page.getByRole("button", { name: /“if .odom pose_x > 1”: 4\s010 of 3\s000 KB\/s/ });
  expect((await bar.findElement()).className).toContain("over");
  const limits = page.getByRole("group", { name: "Limit the findings" });
  const whole = rows().length;
  await limits.getByRole("button", { name: /warning/ }).click();
  await expect.poll(() => rows().length).toBeLessThan(whole);
  expect(row("Note").length).toBe(0);
  await ruler.shown(page.getByCss(".finding-mark.warning").first());
  await ruler.shown(page.getByCss(".finding-mark.info").first());
});

test("a mend offers what costs little, says how much that is, and is optimized", async () => {
  const ruler = await openRules(`\
begin
    SetFrequency /odom 10

    Rule "Look"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /camera Marginal
    EndIf
end
`);
  await row("/camera has no default").getByRole("button", { name: "add SetFrequency /camera Unacceptable" }).click();
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /camera Unacceptable", 'Rule "Look"');
  await expect.poll(() => row("no default").length).toBe(0);
  expect(row("Error").length).toBe(0);
});

async function openRules(text: string, profile = PROFILE): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "radio.adirf": text, "radio.toml": profile } });
  await ruler.open("radio.adirf");
  await expect.element(page.getByLabelText("Topic parameters")).toHaveValue("radio.toml");
  return ruler;
}
