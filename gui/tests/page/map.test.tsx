// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, page } from "vitest/browser";
import type { SaveRequest } from "../../src/api/types";
import { MapPage } from "./map_page";
import { openPage, type RulerPage } from "./ruler_page";

const TWO_MEANINGS = "“1,250” can mean 1.25 or 1250: write 1.25 or 1250.";
const RULES = `\
begin
    SetFrequency /odom 10  // the map needs it

    // Loading bay, 4 m wide
    Rule "Bay" If (CheckValue /odom pose_x > 1.0 AND CheckValue /odom pose_x<5.00 // the gate
        AND (CheckValue /odom pose_y>=2 AND CheckValue /odom pose_y < 6))
    Then SetFrequency /odom 4 EndIf
    Rule "Hall" If CheckValue /odom pose_x > 20 Then SetFrequency /odom 7
end
`;

test("a moved zone changes four numbers and nothing else", async () => {
  const { ruler, map } = await openMap();
  await map.press([3, 4]);
  await expect.element(ruler.button("Bay")).toHaveAttribute("aria-pressed", "true");
  await map.drag([3, 4], [5, 3]);
  await expect.element(map.form.getByLabelText("x from (m)")).not.toHaveValue("1");
  const text = await saved(ruler);
  const [left, right, low, high] = map.sides().map(Number) as [number, number, number, number];
  const moved = map.sides();
  const numbers = /(?<=pose_x > )1\.0|(?<=pose_x<)5\.00|(?<=pose_y>=)2|(?<=pose_y < )6/g;
  expect(text).toBe(RULES.replace(numbers, () => moved.shift() as string));
  expect([right - left, high - low]).toEqual([expect.closeTo(4, 6), expect.closeTo(4, 6)]);
  expect(Math.abs(left - 3)).toBeLessThan(0.3);
  expect(Math.abs(low - 1)).toBeLessThan(0.3);
  await ruler.use("Undo");
  expect(await saved(ruler)).toBe(RULES);
});

test("an added zone is what its fields say", async () => {
  const { ruler, map } = await openMap();
  const add = ruler.button("Add the zone");
  await map.tool("Draw a rectangle");
  await expect.element(add).toBeDisabled();
  await map.typeSides("0", "wide");
  await expect.element(page.getByText('"x to (m)" is not a number.')).toBeVisible();
  await expect.element(add).toBeDisabled();
  await map.form.getByLabelText("x to (m)").fill("-1");
  await expect.element(page.getByText('"x to (m)" must be more than "x from (m)".')).toBeVisible();
  await map.typeSides("11", "15", "7", "11.25");
  await add.click();
  await ruler.shown(page.getByRole("group", { name: "Zone of Zone 1" }));
  expect(map.sides()).toEqual(["11", "15", "7", "11.25"]);

  await map.tool("Draw a polygon");
  const corners = map.form.getByLabelText("Corners");
  await corners.fill("0 0, 4 0, 4 2, 0 2");
  await map.form.getByRole("button", { name: "Show" }).click();
  await expect.element(add).toBeEnabled();
  await corners.fill("0 0, 4 0, 4 9, 0 9");
  await expect.element(add).toBeDisabled();
  await ruler.button("Discard").click();
  await map.tool("Draw a rectangle");
  await map.drag([6, 3], [9, 5]);
  await expect.element(add).toBeEnabled();
});

test("what adds a polygon is seen", async () => {
  const { ruler, map } = await openMap();
  await map.tool("Draw a polygon");
  await map.form.getByLabelText("Corners").fill("0 0, 4 0, 2 3");
  await map.form.getByRole("button", { name: "Show" }).click();
  await expect.element(page.getByText("Rules know rectangles only")).toBeVisible();
  for (const name of ["Add the zone", "Discard"]) await expect.element(ruler.button(name)).toBeInViewport({ ratio: 1 });
  await ruler.button("Add the zone").click();
  await expect.element(ruler.button("Zone 1")).toHaveFocus();
});

test("the wheel scrolls and zooms only with ctrl", async () => {
  const { map } = await openMap();
  const scale = page.getByRole("group", { name: "Scale" });
  const before = scale.element().textContent;
  await map.canvas.hover();
  const isSeen = watchFor("Hold Ctrl to zoom with the wheel");
  await commands.mouseWheel(0, -400);
  await expect.poll(isSeen).toBe(true);
  expect(scale.element().textContent).toBe(before);
  await commands.keyDown("Control");
  await commands.mouseWheel(0, -400);
  await commands.keyUp("Control");
  await expect.poll(() => scale.element().textContent).not.toBe(before);
});

test("a zone is made and moved with the keyboard alone", async () => {
  const ruler = await openPage("empty", { files: { "bay.adirf": RULES } });
  await ruler.walk("Tab", "bay.adirf");
  await commands.press("Enter");
  await expect.element(ruler.button("New rule")).toBeEnabled();
  await ruler.walk("Tab", "Map");
  await commands.press("Enter");
  await ruler.shown(page.getByRole("application", { name: "Zones on the map" }));
  await ruler.walk("Tab", "Draw a rectangle");
  await commands.press("Enter");
  for (const [label, value] of Object.entries({ "x from": "11", "x to": "15", "y from": "7", "y to": "11.25" })) {
    await walkToField(label);
    await commands.press("Control+a");
    await commands.type(value);
  }
  await commands.press("Enter");
  // Nothing can be added, or has the focus, before the zones of the rules are known.
  await expect.element(ruler.button("Add the zone")).toBeEnabled();
  await ruler.walk("Tab", "Add the zone");
  await commands.press("Enter");
  await ruler.shown(page.getByRole("group", { name: "Zone of Zone 1" }));
  await expect.element(ruler.button("Zone 1")).toHaveFocus();
  await walkToField("x to");
  await commands.press("Control+a");
  await commands.type("14.5");
  await commands.press("Enter");
  await ruler.shown(page.getByText("x 11 … 14.5 m, y 7 … 11.25 m"));
  await commands.press("Control+s");
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  const written = [
    "CheckValue /odom pose_x > 11\n",
    "AND CheckValue /odom pose_x < 14.5\n",
    "AND CheckValue /odom pose_y > 7\n",
    "AND CheckValue /odom pose_y < 11.25\n",
  ];
  const text = await ruler.saved("bay.adirf");
  expect(text.startsWith(RULES.replace(/end\n$/, ""))).toBe(true);
  const places = written.map((line) => text.indexOf(line));
  expect(places).not.toContain(-1);
  expect(places).toEqual([...places].sort((one, other) => one - other));
});

test("overlapping zones that clash are named and a handle parts them", async () => {
  const rules = RULES.replace("pose_x > 20", "pose_x > 4");
  const { ruler, map } = await openMap({ rules });
  const clash = page.getByText(/Clash: "Hall" sets \/odom to 7 Hz, "Bay" .* to 4 Hz/);
  await ruler.shown(clash);
  await ruler.button("Bay").click();
  await map.drag([5, 4], [3, 4]);
  await expect.element(clash).not.toBeInTheDocument();
  const [left, right, low] = map.sides();
  expect([left, low]).toEqual(["1", "2"]);
  expect((await saved(ruler)).replace(`pose_x<${right}`, "pose_x<5.00")).toBe(rules);
});

test("an image has the scale that somebody gives it", async () => {
  const { ruler } = await openMap({ project: "plan" });
  const background = page.getByLabelText("Background");
  const scale = page.getByLabelText("Metres per pixel");
  const turn = page.getByLabelText("Turned by (°)");
  const pictures = () =>
    ruler.network.asked.filter(({ ask }) => /\/api\/background\/picture\?.*name=plan\./.test(ask)).length;
  await background.selectOptions("Image: plan.png");
  await expect.poll(pictures).toBeGreaterThan(0);
  await scale.fill("1,250");
  (turn.element() as HTMLElement).focus();
  const problem = page.getByRole("alert");
  await expect.element(problem).toHaveTextContent(`Metres per pixel: ${TWO_MEANINGS}`);
  await scale.fill("0.5");
  await turn.fill("90");
  await expect.element(problem).not.toBeInTheDocument();
  await ruler.press(turn, "Tab");
  await ruler.save();
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.open("bay.adirf");
  await MapPage.open(ruler);
  await expect.element(scale).toHaveValue("0.5");
  await expect.element(turn).toHaveValue("90");
  await background.selectOptions("Plain grid");
  await ruler.save();
  const saves = ruler.network.asked.filter(({ ask }) => ask === "PUT /api/file").map(({ body }) => body as SaveRequest);
  const texts = saves.filter(({ name }) => name === "bay.adirf").map(({ text }) => text);
  expect(texts.filter((text) => text !== RULES)).toEqual([]);
});

test("a robot that knows its place in the map is drawn there and read there", async () => {
  const { ruler, map } = await openMap({ project: "localized" });
  await page.getByLabelText("Path of").selectOptions("monday");
  const note = page.getByText("The path is that of /amcl_pose, in the frame map.");
  await expect.element(note).toHaveTextContent("Zones read /odom, whose positions may lie elsewhere.");
  await map.tool("Draw a rectangle");
  await expect.element(map.form.getByLabelText("Position from")).toHaveValue("/amcl_pose");
  await map.typeSides("0", "1", "0", "1");
  await ruler.button("Add the zone").click();
  await ruler.shown(page.getByRole("group", { name: "Zone of Zone 1" }));
  expect(await saved(ruler)).toContain("CheckValue /amcl_pose pose_x > 0");
});

test("a condition on y alone is a band without ends", async () => {
  const band = "(CheckValue /odom pose_y > 12 AND CheckValue /odom pose_y < 15)";
  const { ruler, map } = await openMap({ rules: RULES.replace("CheckValue /odom pose_x > 20", band) });
  const zoomOut = page.getByRole("region", { name: "Map" }).getByRole("button", { name: "Zoom out" });
  for (let step = 0; step < 4; step++) await zoomOut.click();
  await map.press([60, 13.5]);
  await expect.element(ruler.button("Hall")).toHaveAttribute("aria-pressed", "true");
  expect(map.sides()).toEqual(["", "", "12", "15"]);
});

test.each([
  ["4", "10"],
  ["Full", "10"],
  ["25", "Full"],
])("a new zone proposes a rate that is not the default: %s", async (usual, proposed) => {
  const { ruler, map } = await openMap({ rules: RULES.replace("/odom 10 ", `/odom ${usual} `) });
  await map.tool("Draw a rectangle");
  await map.typeSides("0", "1", "0", "1");
  await ruler.button("Add the zone").click();
  await ruler.shown(page.getByRole("group", { name: "Zone of Zone 1" }));
  expect(await saved(ruler)).toContain(`SetFrequency /odom ${proposed}\n    EndIf\nend`);
});

async function openMap({ rules = RULES, project = "empty" } = {}): Promise<{ ruler: RulerPage; map: MapPage }> {
  const ruler = await openPage(project, { files: { "bay.adirf": rules } });
  await ruler.open("bay.adirf");
  return { ruler, map: await MapPage.open(ruler) };
}

async function saved(ruler: RulerPage): Promise<string> {
  await ruler.save();
  return ruler.saved("bay.adirf");
}

async function walkToField(label: string): Promise<void> {
  for (let step = 0; step < 60; step++) {
    await commands.press("Tab");
    const { labels } = document.activeElement as HTMLInputElement;
    if ([...(labels ?? [])].some((each) => each.textContent?.startsWith(label))) return;
  }
  throw new Error(`Tab does not lead to "${label}"`);
}

/** Whether an element that says this came, however short it stayed. */
function watchFor(words: string): () => boolean {
  let isSeen = false;
  const look = () => {
    isSeen ||= document.body.innerText.includes(words);
  };
  new MutationObserver(look).observe(document.body, { childList: true, subtree: true, characterData: true });
  return () => isSeen;
}
