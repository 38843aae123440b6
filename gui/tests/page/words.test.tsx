// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { test } from "vitest";
import { commands, page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /mode Full

    Rule "Dock"
    If CheckValue /mode data > 0
    Then
        SetFrequency /mode 4
    EndIf
end
`;

test("a word that somebody types is a text, and is equal or not", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit value: 0")).click();
  await commands.type("on the way");
  await commands.press("Enter");
  await ruler.expectLines('If CheckValue /mode data = "on the way"');
  await ruler.change('Edit value: "on the way"', "DiagnosticStatus.ERROR");
  await ruler.expectLines("If CheckValue /mode data = DiagnosticStatus.ERROR");
  await (await ruler.field("Edit value: DiagnosticStatus.ERROR")).click();
  await commands.press("Control+a");
  await commands.type('"open');
  await ruler.shown(page.getByText("Compared is with a number, a text, true, false or a constant"));
  await commands.press("Escape");
  await ruler.expectLines("If CheckValue /mode data = DiagnosticStatus.ERROR");
});

test("the texts of the recording are listed, and typing finds one of them", async () => {
  const ruler = await openDock();
  await (await ruler.field("Edit value: 0")).click();
  await ruler.shown(page.getByRole("option", { name: '"docking" in the recording' }));
  await commands.type("char");
  await commands.press("Enter");
  await ruler.expectLines('If CheckValue /mode data = "charging"');
  await (await ruler.field("Add time")).click();
  await page.getByRole("menuitem", { name: "until…", exact: true }).click();
  await ruler.shown(page.getByRole("combobox", { name: "value of the end" }));
  await commands.press("Control+a");
  await commands.type("driv");
  await commands.press("Enter");
  await ruler.expectLines('CheckValue /mode data = "charging" Until != "driving"');
});

test("a property that is a number for sure takes numbers alone", async () => {
  const ruler = await openDock("CheckValue /odom speed > 0");
  await (await ruler.field("Edit value: 0")).click();
  await commands.press("Control+a");
  await commands.type("fast");
  await ruler.shown(page.getByText("“fast” is not a number"));
  await commands.press("Escape");
  await ruler.expectLines("CheckValue /odom speed > 0");
});

test("an action is added by the keyboard alone, and one more below it", async () => {
  const ruler = await openDock();
  await (await ruler.field("Add action")).click();
  await commands.press("Enter");
  await ruler.typeValue("/controller");
  await ruler.expectLines("SetParameter /controller parameter 0");
  await commands.press("Shift+Enter");
  await ruler.typeValue("/planner");
  await ruler.expectLines("SetParameter /controller parameter 0", "SetParameter /planner parameter 0");
});

async function openDock(check = "CheckValue /mode data > 0"): Promise<RulerPage> {
  const files = { "dock.adirf": RULES.replace("CheckValue /mode data > 0", check) };
  const ruler = await openPage("modes", { files });
  await ruler.open("dock.adirf");
  return ruler;
}
