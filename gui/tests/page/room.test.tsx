// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import { boxOf, openPage, type RulerPage } from "./ruler_page";

const WIDTH_PX = 1440;
const ZONE = `\
begin
    Rule "Zone"
    If (CheckValue /odom pose_y > 2)
    Then
        SetFrequency /odom 5
    EndIf
end
`;
const OPTIMIZE = "Optimize and Download";

/** The places of the page are beside the panes. */
const RAIL_PX = 92;

test("panes are as large as somebody left them", async () => {
  const ruler = await openZone("empty");
  const line = page.getByRole("separator", { name: "Width of the blocks" });
  await expect.element(line).toHaveAttribute("aria-valuenow", "58");
  await ruler.press(line, "ArrowLeft", "PageDown");
  await expect.element(line).toHaveAttribute("aria-valuenow", "46");
  const low = page.getByRole("separator", { name: "Height of the results" });
  await ruler.press(low, "End");
  await expect.element(low).toHaveAttribute("aria-valuenow", "85");
  await ruler.press(low, "ArrowDown");
  await ruler.reload();
  await expect.element(line).toHaveAttribute("aria-valuenow", "46");
  await expect.element(low).toHaveAttribute("aria-valuenow", "83");
  await expect.poll(async () => (await boxOf(ruler.blocks)).width / (WIDTH_PX - RAIL_PX)).toBeCloseTo(0.46, 2);
});

test("the line between panes is pulled", async () => {
  await openZone("empty");
  const line = page.getByRole("separator", { name: "Width of the blocks" });
  await line.hover();
  await commands.mouseDown();
  await commands.mouseMove((WIDTH_PX + RAIL_PX) / 2, 400, 4);
  await commands.mouseUp();
  await expect.element(line).toHaveAttribute("aria-valuenow", "50");
  await commands.mouseMove(WIDTH_PX / 4, 400);
  await expect.element(line).toHaveAttribute("aria-valuenow", "50");
});

test("a download waits for the profile that was just chosen", async () => {
  const entry = (topic: string) => `[topics."${topic}"]\nmessage_kb = 0.5\ntiers_hz = [1, 2, 3, 4, 5, 6]\n`;
  const entries = ["/odom", "/imu", "/camera/image_raw/compressed"].map(entry);
  const files = { "quality/third.toml": `budget_kb_per_s = 4000\n${entries.join("")}` };
  const ruler = await openPage("inspection", { files });
  await ruler.open("quality/inspection.adirf");
  await expect.element(page.getByLabelText("Topic parameters")).toHaveValue("quality/radio.toml");
  const release = ruler.network.hold("GET /api/file", "third.toml");
  const asked = ruler.network.count("GET /api/file");
  await page.getByLabelText("Topic parameters").selectOptions("quality/third.toml");
  await expect.poll(() => ruler.network.count("GET /api/file")).toBeGreaterThan(asked);
  const download = commands.nextDownload();
  await ruler.use(OPTIMIZE);
  release();
  expect((await download).text.split("\n")[0]).toContain(", profile third.toml (sha256 ");
});

test("what cannot be downloaded is said", async () => {
  const ruler = await openPage("inspection");
  await ruler.open("quality/inspection.adirf");
  await page.getByLabelText("Topic parameters").selectOptions("none");
  await ruler.use(OPTIMIZE);
  const dialog = page.getByRole("dialog", { name: "Rates within the budget" });
  await ruler.shown(dialog.getByText("Nothing was downloaded yet."));
  // What is missing can be chosen there, and the rates are told at once.
  await dialog.getByLabelText("Topic parameters").selectOptions("quality/radio.toml");
  await expect.element(dialog.getByText(/^Everything fits into/)).toBeVisible();
  const download = commands.nextDownload();
  await dialog.getByRole("button", { name: "Download" }).click();
  expect((await download).name).toBe("inspection-rates.adirf");
  await expect.element(dialog).not.toBeInTheDocument();
});

test("rules in plain numbers are downloaded without a profile", async () => {
  const text = "begin\n    SetFrequency /odom 10\nend\n";
  const ruler = await openPage("inspection", { files: { "plain.adirf": text } });
  await ruler.open("plain.adirf");
  await page.getByLabelText("Topic parameters").selectOptions("none");
  const download = commands.nextDownload();
  await ruler.use(OPTIMIZE);
  await expect.element(page.getByText("Downloaded the rules as they are")).toBeVisible();
  expect(await download).toEqual({ name: "plain-rates.adirf", text });
});

test("one main button says what is next", async () => {
  const ruler = await openZone("empty");
  const main = page.getByRole("toolbar", { name: "Tools" }).getByCss("button.primary");
  await expect.element(main).toHaveAccessibleName(OPTIMIZE);
  await ruler.button("New rate").click();
  await expect.element(main).toHaveAccessibleName("Save");
  await ruler.save();
  await expect.element(main).toHaveAccessibleName(OPTIMIZE);
});

async function openZone(project: string): Promise<RulerPage> {
  const ruler = await openPage(project, { files: { "zone.adirf": ZONE } });
  await ruler.open("zone.adirf");
  return ruler;
}
