// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { openPage } from "./ruler_page";

const MINE = `\
begin
    SetFrequency /odom 10  // mine

    Rule "Bay"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4
    EndIf
end
`;
const THEIRS = `\
begin
    SetFrequency /odom 20
    SetFrequency /imu 5
    KeepAtLeast /scan often

    // fast there
    Rule "Bay"
    If CheckValue /odom pose_x > 2
    Then
        SetFrequency /odom 8
    EndIf

    Rule "Aisle"
    If CheckValue /odom pose_y > 1
    Then
        SetFrequency /odom 2
    EndIf
end
`;

test("the selected rules are exported with their comments", async () => {
  const ruler = await openPage("empty", { files: { "theirs.adirf": THEIRS } });
  await ruler.open("theirs.adirf");
  await ruler.use("Export");
  const dialog = page.getByRole("dialog", { name: "Export rules" });
  await expect.element(dialog.getByRole("checkbox", { name: "KeepAtLeast /scan often" })).toBeDisabled();
  await dialog.getByRole("checkbox", { name: "Rule Bay" }).click();
  await dialog.getByRole("checkbox", { name: "/imu at 5 Hz" }).click();
  const waiting = commands.nextDownload();
  await dialog.getByRole("button", { name: "Export selected rules" }).click();
  const imu = "    SetFrequency /imu 5";
  const rule = THEIRS.slice(THEIRS.indexOf("    //"), THEIRS.indexOf("EndIf") + "EndIf".length);
  expect((await waiting).text).toBe(`begin\n${imu}\n\n${rule}\nend\n`);
  await expect.element(dialog).not.toBeInTheDocument();
});

test("a file dropped on the editor is imported where it was not there before", async () => {
  const ruler = await openPage("empty", { files: { "mine.adirf": MINE } });
  await ruler.open("mine.adirf");
  drop("other.adirf", MINE.replace("SetFrequency /odom 10  // mine", "SetFrequency /imu 7"));
  const dialog = page.getByRole("dialog", { name: "Import rules" });
  await expect.element(dialog.getByText("is here already, in line 4")).toBeVisible();
  await expect.element(dialog.getByRole("checkbox", { name: "Rule Bay" })).not.toBeChecked();
  await dialog.getByRole("button", { name: "Import", exact: true }).click();
  await ruler.expectLines("SetFrequency /odom 10 // mine", "SetFrequency /imu 7", "Bay");
  await ruler.save();
  expect(await ruler.saved("mine.adirf")).toBe(MINE.replace("// mine\n", "// mine\n    SetFrequency /imu 7\n"));
});

test("an import with many findings keeps its button in view", async () => {
  const ruler = await openPage("empty", { files: { "mine.adirf": MINE } });
  await ruler.open("mine.adirf");
  const rules = Array.from(
    { length: 40 },
    (_, number) => `Rule "R${number}" If CheckValue /odom pose_x > ${number} Then SetFrequency /odom 5 EndIf\n`,
  );
  drop("many.adirf", `begin\n${rules.join("")}end\n`);
  const dialog = page.getByRole("dialog", { name: "Import rules" });
  const found = dialog.getByRole("list", { name: "Findings of the import" }).getByRole("listitem");
  await expect.element(found.nth(30)).toBeInTheDocument();
  await expect.element(dialog.getByRole("button", { name: "Import", exact: true })).toBeInViewport();
});

test("a dropped file that is no text is refused with a sentence", async () => {
  const ruler = await openPage("empty", { files: { "mine.adirf": MINE } });
  await ruler.open("mine.adirf");
  drop("image.png", new Uint8Array([0x89, 0x50, 0x4e, 0x47, 0xff]));
  await expect.element(page.getByRole("alert")).toHaveTextContent("image.png is not UTF-8 text");
});

test("a rule file dropped on the first screen becomes a file of the project", async () => {
  const ruler = await openPage("empty");
  drop("mine.adirf", MINE);
  await ruler.expectLines("SetFrequency /odom 10 // mine");
  expect(await onDisk("mine.adirf")).toBe(MINE);
  await ruler.home();
  drop("mine.adirf", "begin end");
  await expect.element(page.getByRole("alert")).toHaveTextContent("has a mine.adirf already");
  expect(await onDisk("mine.adirf")).toBe(MINE);
});

/** Drops a file of the user's disk on the middle of the page. */
function drop(name: string, data: BlobPart): void {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([data], name));
  const dropped = new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
  page.getByRole("main").element().dispatchEvent(dropped);
}

/** The text that the server has now. */
async function onDisk(name: string): Promise<string> {
  return (await (await fetch(`api/file?name=${name}`)).json()).text;
}
