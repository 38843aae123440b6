// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, onTestFinished, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { boxOf, openPage, resize } from "./ruler_page";

const LAPTOP = [1280, 800] as const;
const TELEPHONE = [390, 844] as const;
/** The contrast that WCAG asks of text. */
const READABLE = 4.5;
const CLASH = `\
begin
    Rule "Hall" If CheckValue /odom pose_x > 4 Then SetFrequency /odom 7
    Rule "Bay" If CheckValue /odom pose_x > 1 Then SetFrequency /odom 4
end
`;
const NOTE_AND_WARNING = `\
begin
    SetFrequency /odom 10
    Rule "Same" If CheckValue /odom pose_x > 0 Then SetFrequency /odom 10
    Rule "Never" If (CheckValue /odom pose_x > 0 AND CheckValue /odom pose_x < 0) Then SetFrequency /odom 4
end
`;
const DECIDES = `\
begin
    SetFrequency /odom 5
    Rule "Always"
    If (CheckValue /odom pose_y > -1)
    Then
        SetFrequency /odom 2
        SetFrequency /scan 1
        SetFrequency /image 1
        SetFrequency /gripper 1
        SetFrequency /map_name 1
    EndIf
end
`;
const RADIO = "quality/radio.toml";

test("a name goes on in the next line between its words", async () => {
  await resize(...TELEPHONE);
  const text = "begin\nend\n";
  const names = ["warehouse_predicted.adirf", "warehouse_within.adirf"];
  const files = { "warehouse.adirf": text, ...Object.fromEntries(names.map((name) => [name, text])) };
  const ruler = await openPage("empty", { files });
  for (const name of names) {
    const link = page.getByRole("link", { name, exact: true }).element();
    expect(linesOfParts(link)).toEqual([1, 1, 1]);
  }
  await ruler.open("warehouse.adirf");
  expect(linesOfParts(await page.getByRole("heading", { level: 1 }).findElement())).toEqual([1, 1]);
});

test.each(["", "rules/warehouse.adirf", `topics/${RADIO}`, "incidents/"])(
  "who wants larger text gets all of it larger and no page wider: %s",
  async (address) => {
    await resize(...TELEPHONE);
    const ruler = await openPage("examples", { hash: `#/${address}` });
    await ruler.shown(page.getByRole("heading", { level: 1 }));
    const texts = [...document.querySelectorAll("h1, button, input, select, a, p, .cm-line")].filter(
      (each) => each.closest(".injectionDiv") === null,
    );
    const sizes = () => texts.map((each) => Number.parseFloat(getComputedStyle(each).fontSize));
    const before = sizes();
    expect(before.length).toBeGreaterThan(0);
    // The largest text that a browser offers by name.
    document.documentElement.style.fontSize = "150%";
    onTestFinished(() => void document.documentElement.style.removeProperty("font-size"));
    for (const [at, px] of sizes().entries()) expect(px / (before[at] as number)).toBeCloseTo(1.5);
    await expect.poll(() => document.documentElement.scrollWidth - innerWidth).toBeLessThanOrEqual(0);
  },
);

test("only what one begins with stands out", async () => {
  await commands.mouseMove(0, 0);
  const files = { "zone.adirf": "begin\nend\n" };
  const ruler = await openPage("empty", { files });
  const colour = () => getComputedStyle(ruler.button("New Rule File").element()).backgroundColor;
  const usual = colour();
  await ruler.write({ "zone.adirf": null });
  await ruler.reload();
  await expect.element(page.getByRole("link", { name: "zone.adirf" })).not.toBeInTheDocument();
  expect(colour()).not.toBe(usual);
});

test.each(["light", "dark"] as const)("the words of an empty field can be read: %s", async (scheme) => {
  await commands.colorScheme(scheme);
  onTestFinished(() => commands.colorScheme("light"));
  await openPage("empty", { files: { "zone.adirf": "begin\nend\n" } });
  const field = await page.getByRole("searchbox", { name: "Find a file" }).findElement();
  const colours = [getComputedStyle(field, "::placeholder").color, getComputedStyle(field).backgroundColor];
  const [low, high] = colours.map(luminance).sort((one, other) => one - other) as [number, number];
  expect((high + 0.05) / (low + 0.05)).toBeGreaterThanOrEqual(READABLE);
});

test("findings begin below each other and have more room than their buttons", async () => {
  await resize(...LAPTOP);
  const ruler = await openPage("examples");
  await ruler.open("warehouse.adirf");
  const rows = findings();
  await expect.poll(() => rows.length).toBe(3);
  const messages = rows.elements().map(messageBox);
  expect(new Set(messages.map(({ x }) => x)).size).toBe(1);
  const fix = rows.last().getByRole("button", { name: /^pace .camera.camera_info with/ });
  expect(messages.at(-1)?.width).toBeGreaterThan((await boxOf(fix)).width);
  expect(isCut(fix)).toBe(false);
});

test("a long name of a rule leaves its finding readable", async () => {
  const files = { "clash.adirf": CLASH.replace("Hall", "Hall of the second floor, ".repeat(12)) };
  const ruler = await openPage("empty", { files });
  await ruler.open("clash.adirf");
  const bay = page.getByRole("button", { name: "Rule Bay", exact: true });
  const clash = findings().filter({ has: bay }).first();
  const message = messageBox(await clash.findElement());
  const room = await boxOf(page.getByRole("region", { name: "Results" }));
  expect(message.width).toBeGreaterThan(room.width / 3);
  const buttons = clash.getByRole("button").elements();
  expect(buttons.length).toBeGreaterThan(0);
  for (const button of buttons) expect(button.getBoundingClientRect().right).toBeLessThanOrEqual(room.right);
});

test("a warning begins where a note does", async () => {
  const ruler = await openPage("empty", { files: { "mixed.adirf": NOTE_AND_WARNING } });
  await ruler.open("mixed.adirf");
  const rows = findings();
  await ruler.shown(rows.filter({ hasText: "Note" }).first());
  await ruler.shown(rows.filter({ hasText: "Warning" }).first());
  expect(new Set(rows.elements().map((row) => messageBox(row).x)).size).toBe(1);
});

test("nothing covers a field of the topic parameters on a laptop", async () => {
  await resize(...LAPTOP);
  const ruler = await openPage("inspection");
  await page.getByRole("link", { name: RADIO, exact: true }).click();
  const field = await boxOf(page.getByRole("textbox", { name: "Source (Hz) of /odom" }));
  expect(field.right).toBeLessThan((await boxOf(ruler.button("Remove /odom"))).left);
  expect(isCut(page.getByCss(".table-scroll").first())).toBe(false);
});

test("the name of a topic is not cut beside its load", async () => {
  await resize(...LAPTOP);
  const ruler = await openPage("inspection");
  await ruler.open("quality/inspection.adirf");
  await ruler.openRates();
  const names = page.getByRole("rowheader", { name: "/camera/image_raw/compressed" });
  await ruler.shown(names.first());
  for (const name of names.all()) expect(isCut(name)).toBe(false);
});

test("the map says what is below the zones and why two clash", async () => {
  const ruler = await openPage("examples", { files: { "clash.adirf": CLASH } });
  await ruler.open("clash.adirf");
  await ruler.openPane("Map");
  const background = page.getByRole("combobox", { name: "Background" });
  await expect.element(background.getByRole("option", { name: "Map: warehouse_map.yaml" })).toBeInTheDocument();
  const field = background.element();
  const copy = field.cloneNode(true) as HTMLElement;
  copy.style.cssText = "position: fixed; max-width: none";
  field.parentNode?.append(copy);
  const wantedPx = copy.getBoundingClientRect().width;
  copy.remove();
  expect((await boxOf(background)).width).toBeGreaterThanOrEqual(wantedPx - 1);
  const panel = page.getByRole("region", { name: "Map", exact: true });
  await ruler.shown(panel.getByText("The higher rate wins; give one block a higher Priority"));
});

test("the slider of a try has the width that values leave it on a telephone", async () => {
  await resize(...TELEPHONE);
  const ruler = await openPage("monday", { files: { "far.adirf": DECIDES } });
  await ruler.open("far.adirf");
  await ruler.openPane("Try on a recording");
  await ruler.button("Run the rules on it").click();
  const slider = page.getByRole("slider", { name: "Time in the recording (s)" });
  expect((await boxOf(slider)).width).toBeGreaterThan(0.8 * TELEPHONE[0]);
  await ruler.press(slider, "End");
  const decides = page.getByText(/^decides .odom/);
  for (const [width, height] of [TELEPHONE, LAPTOP]) {
    await resize(width, height);
    await expect.poll(() => innerWidth).toBe(width);
    await expect.element(decides).toHaveTextContent(/^decides \/odom, \/scan, \/image, \/gripper, \/map_name$/);
    expect(isCut(decides)).toBe(false);
  }
});

/** In how many lines each text of an element is, beside the texts of those in it. */
function linesOfParts(of: Element): number[] {
  const parts = [...of.childNodes].filter(({ nodeType }) => nodeType === Node.TEXT_NODE);
  return parts.map((part) => {
    const range = document.createRange();
    range.selectNode(part);
    return range.getClientRects().length;
  });
}

function luminance(colour: string): number {
  const parts = (colour.match(/[\d.]+/g) ?? []).slice(0, 3).map((part) => Number(part) / 255);
  const [r, g, b] = parts.map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * (r ?? 0) + 0.7152 * (g ?? 0) + 0.0722 * (b ?? 0);
}

function findings(): Locator {
  return page.getByRole("list", { name: "Findings" }).getByRole("listitem");
}

function messageBox(row: Element): DOMRect {
  return (row.querySelector(".message") as Element).getBoundingClientRect();
}

function isCut(found: Locator): boolean {
  const { scrollWidth, clientWidth } = found.element();
  return scrollWidth > clientWidth;
}
