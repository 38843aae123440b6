// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { violations } from "./axe";
import { boxOf, openPage, type RulerPage, resize } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 5
    SetFrequency /scan 1
    Rule "Far"
    If (CheckValue /odom pose_y > 2)
    Then
        SetFrequency /scan 5
    EndIf
end
`;
const FILES = { "far.adirf": RULES };
const RUN = "Run the rules on it";
const STALE = "Stale: rules changed since.";

test("the loss stands beside and old numbers say that they are old", async () => {
  const ruler = await openPage("monday", { files: FILES });
  await tryRules(ruler, "far.adirf");
  const loss = page.getByRole("region", { name: "What the operator loses" });
  const errors = loss.getByRole("table", { name: "Error when the last received value is held" });
  await expect.element(errors.getByRole("row", { name: "/odom pose_y" })).toHaveTextContent("m");
  const ages = loss.getByRole("table", { name: "Age of the newest message received" });
  await expect.element(ages).toHaveTextContent("/scan");
  const thresholds = loss.getByRole("table", { name: "Thresholds of your checks" });
  await expect.element(thresholds).toHaveTextContent("/odom pose_y > 2");
  await loss.getByLabelText("Error over time of").selectOptions("/odom pose_y");
  await expect.element(loss.getByRole("figure", { name: "Error of /odom pose_y" })).toBeVisible();

  await ruler.text.getByText("SetFrequency /odom 5").click();
  await commands.press("End", "0");
  await expect.element(page.getByText(STALE)).toBeVisible();
  await ruler.button(RUN).click();
  await expect.element(page.getByText(STALE)).not.toBeInTheDocument();
  await awaitZones(ruler, "/odom 50");
});

test("a result stays with its file and says what changed since", async () => {
  const files = { "monday.adirf": RULES, "other.adirf": "begin\n    SetFrequency /scan 1\nend\n" };
  const ruler = await openPage("two_drives", { files });
  await ruler.open("monday.adirf");
  await ruler.openPane("Try on a recording");
  // The one that the rules have their name from, though another is longer.
  await expect.element(page.getByRole("combobox", { name: "Recording" })).toHaveValue("monday");
  await run(ruler);
  const time = page.getByRole("slider", { name: "Time in the recording (s)" });
  await ruler.press(time, "End");
  const replays = ruler.network.count("POST /api/try");

  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.open("other.adirf");
  await ruler.openPane("Try on a recording");
  await expect.element(ruler.button(RUN)).toBeVisible();
  await expect.element(page.getByText("% less sent")).not.toBeInTheDocument();
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.open("monday.adirf");
  await ruler.openPane("Try on a recording");
  await expect.element(time).toHaveValue("7.96");
  await expect.element(page.getByText("Stale:")).not.toBeInTheDocument();
  expect(ruler.network.count("POST /api/try")).toBe(replays);

  await ruler.write({ "monday/metadata.yaml": "another recording" });
  dispatchEvent(new Event("focus"));
  await expect.element(page.getByText("Stale: recording changed since.")).toBeVisible();
});

test("a try goes on while another page is looked at", async () => {
  const ruler = await openPage("monday", { files: FILES });
  await ruler.open("far.adirf");
  await ruler.openPane("Try on a recording");
  const release = ruler.network.hold("POST /api/try");
  await ruler.button(RUN).click();
  await expect.poll(() => ruler.network.count("POST /api/try")).toBe(1);
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.open("far.adirf");
  await ruler.openPane("Try on a recording");
  release();
  await expect.element(page.getByText("% less")).toBeVisible();
  expect(ruler.network.count("POST /api/try")).toBe(1);
});

test("gain and loss stand on one line and messages are sentences", async () => {
  const few = "begin\n    SetFrequency /image 1\n    SetFrequency /scan Marginal\nend\n";
  const ruler = await openPage("monday", { files: { "few.adirf": few } });
  await ruler.open("few.adirf");
  await expect.element(page.getByText("1 finding", { exact: true })).toBeInTheDocument();
  const findings = page.getByRole("list", { name: "Findings" }).getByCss(".message");
  await expect.element(findings).toHaveTextContent(/^[A-Z/]/);
  await ruler.text.getByText("SetFrequency /scan").click();
  await commands.press("End", "Control+Shift+ArrowLeft");
  await commands.type("Full");
  await ruler.openPane("Try on a recording");
  await ruler.button(RUN).click();
  await expect.element(page.getByText(/^[\d.]+ % less sent; \/image: \d+ of \d+, dark for [\d.]+ s$/)).toBeVisible();
  await expect.element(page.getByText("The rules decided 2 times")).toBeVisible();
  await awaitZones(ruler, "Full");
});

test("a threshold that is dragged says when it would have held", async () => {
  const ruler = await openPage("monday", { files: FILES });
  await tryRules(ruler, "far.adirf");
  const rules = page.getByRole("region", { name: "Rules at this time" });
  const held = rules.getByRole("img", { name: /^Far: Holds for 5\.\d+ s of 7\.96 s/ });
  await expect.element(held).toBeVisible();

  const why = page.getByRole("region", { name: "Why this threshold" });
  await why.getByRole("combobox").selectOptions("/odom pose_y > 2 (Far)");
  const figure = why.getByRole("figure", { name: "Value of /odom pose_y" });
  await expect.element(figure.getByCss("canvas")).toBeVisible();
  const status = why.getByRole("status");
  await expect.element(status).toHaveTextContent(/^> 2: Holds for 5\.\d+ s of 7\.96 s/);
  const line = why.getByRole("slider", { name: "Threshold" });
  await line.hover();
  // The pointer may have scrolled the chart into view.
  const { left, top, width, height } = await boxOf(why.getByCss(".u-over"));
  await commands.mouseDown();
  await commands.mouseMove(left + width / 2, top + height / 2);
  await commands.mouseUp();
  await expect.element(status).toHaveTextContent(/^> (3\.9|4).*: Holds for (3\.9|4).* s of 7\.96 s/);
  await ruler.press(line, "PageUp");
  await expect.element(status).toHaveTextContent(/^> [45]\S*: Holds for [23]\.\d+ s of 7\.96 s/);

  // The bar of the condition moves the one time, as the charts do.
  await pressAt(why.getByRole("img", { name: /^The condition: / }), 0.5);
  const slider = page.getByRole("slider", { name: "Time in the recording (s)" });
  await expect.element(slider).toHaveAttribute("aria-valuetext", expect.stringMatching(/^(3\.9|4\.0)/));

  const value = line.element().getAttribute("aria-valuenow");
  await why.getByRole("button", { name: /^Write .* into the rules$/ }).click();
  await ruler.expectLines(`CheckValue /odom pose_y > ${value}`);
  await expect.element(page.getByText(STALE)).toBeVisible();
  await awaitZones(ruler, `pose_y > ${value}`);
});

test.each([1440, 820, 390])("what stands below each other is at the same time: %i", async (width) => {
  await resize(width, 900);
  const ruler = await openPage("monday", { files: FILES });
  await tryRules(ruler, "far.adirf");
  await page
    .getByRole("region", { name: "Why this threshold" })
    .getByRole("combobox")
    .selectOptions("/odom pose_y > 2 (Far)");
  await expect.element(page.getByRole("img", { name: /^The condition: / })).toBeInTheDocument();
  const plots = [...document.querySelectorAll(".scrubber-track, .lane-plot, .lane .u-over, .stretches")];
  expect(plots.length).toBeGreaterThan(10);
  const edges = plots.map((plot) => plot.getBoundingClientRect()).map(({ left, right }) => [left, right]);
  // The middle of the slider's thumb is the time.
  const { left, right } = await boxOf(page.getByRole("slider", { name: "Time in the recording (s)" }));
  const [first = [0, 0]] = edges;
  for (const [one = 0, other = 0] of [...edges, [left + 8, right - 8]]) {
    expect(Math.abs(one - (first[0] ?? 0))).toBeLessThanOrEqual(1);
    expect(Math.abs(other - (first[1] ?? 0))).toBeLessThanOrEqual(1);
  }
  // One colour a rule: that of its lane, its name, and of the rates that it decides.
  const colours = [".rule-states .stretches path", '[aria-label="What decides /scan"] path'].map(
    (selector) => getComputedStyle(document.querySelector(selector) as Element).fill,
  );
  const swatch = getComputedStyle(document.querySelector(".swatch") as Element).backgroundColor;
  expect(colours).toEqual([swatch, swatch]);
  expect(await violations()).toEqual([]);
});

async function tryRules(ruler: RulerPage, name: string): Promise<void> {
  await ruler.open(name);
  await ruler.openPane("Try on a recording");
  await run(ruler);
}

async function run(ruler: RulerPage): Promise<void> {
  await ruler.button(RUN).click();
  await expect.element(page.getByText(/[\d.]+ % less/)).toBeVisible();
  await expect.element(page.getByText("The rules decided")).toBeVisible();
}

/** Waits until the page asked for the zones of a text with these words, which it does last of all. */
async function awaitZones({ network }: RulerPage, words: string): Promise<void> {
  const asked = () => network.asked.filter(({ ask, body }) => ask === "POST /api/zones" && holds(body, words));
  await expect.poll(() => asked().length).toBeGreaterThan(0);
}

function holds(body: unknown, words: string): boolean {
  return JSON.stringify(body).includes(words);
}

/** Presses where this share of the chart is left of. */
async function pressAt(chart: Locator, share: number): Promise<void> {
  const { width, height } = await boxOf(chart);
  await chart.click({ position: { x: width * share, y: height / 2 }, force: true });
}
