// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, onTestFinished, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { boxOf, openPage, resize, typedIn } from "./ruler_page";

const PROFILE = `\
# Our radio.
[topics."/odom"]
message_kb = 0.7
tiers_hz = [1, 2, 5, 10, 15, 20]
`;

test("lines are dragged or moved by keys and the table follows", async () => {
  const ruler = await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  const [desirable, cell] = [line("Desirable"), cellOf("Desirable")];
  await expect.element(desirable).toHaveAttribute("aria-valuetext", "10 Hz");
  await ruler.press(desirable, "ArrowRight");
  await expect.element(cell).toHaveValue("11");
  await ruler.press(desirable, "End");
  await expect.element(cell).toHaveValue("15");
  await ruler.press(desirable, "ArrowUp");
  await expect.element(cell).toHaveValue("15");
  await expect.element(page.getByText("Desirable stops at Competitive (15 Hz)")).toBeVisible();

  await dragLine(desirable, -60);
  await expect.element(cell).not.toHaveValue("15");
  expect(Number(typedIn(cell))).toBeGreaterThanOrEqual(5);
  expect(Number(typedIn(cell))).toBeLessThan(15);
  await ruler.use("Undo");
  await expect.element(cell).toHaveValue("15");
  for (let step = 0; step < 3; step++) await ruler.use("Undo");
  await expect.element(cell).toHaveValue("10");
  await expect.element(await ruler.tool("Undo")).toBeDisabled();

  await cell.fill("12");
  await expect.element(desirable).toHaveAttribute("aria-valuenow", "12");
  await ruler.use("Save");
  await expect.element(page.getByText("Saved radio.toml")).toBeVisible();
  expect(await ruler.saved("radio.toml")).toBe(PROFILE.replace("10", "12"));
});

test("what a rate looks like is shown beside the source, in words where somebody wants no motion", async () => {
  const ruler = await openPage("radio", { files: { "radio.toml": `${PROFILE}source_hz = 50\n` } });
  await page.getByRole("link", { name: "radio.toml" }).click();
  const dots = page.getByRole("group", { name: "What a rate looks like" });
  await ruler.shown(dots.getByText("50 Hz, as the source sends: one message each 0.02 s"));
  ((await line("Marginal").findElement()) as HTMLElement).focus();
  await ruler.shown(dots.getByText("2 Hz: one message each 0.5 s"));
  const placeOf = () => dots.getByCss("i").first().element().getBoundingClientRect().left;
  const still = placeOf();
  await new Promise((done) => setTimeout(done, 700));
  expect(placeOf()).toBe(still);
  await commands.emulateMotion("no-preference");
  onTestFinished(() => commands.emulateMotion("reduce"));
  ((await line("Acceptable").findElement()) as HTMLElement).focus();
  await ruler.shown(dots.getByText("5 Hz: one message each 0.2 s"));
  await expect.poll(placeOf).not.toBe(still);
});

test.each([1280, 390])("a level's name is inside its band, which ends at its line: %i", async (width) => {
  await resize(width, 800);
  await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  await awaitAxis();
  for (const [level, hz] of Object.entries({ Unacceptable: 1, Marginal: 2, Desirable: 10 })) {
    const name = page.getByText(`${level}, up to ${hz} Hz`);
    const [text, band, end] = await Promise.all([
      boxOf(name),
      boxOf(page.getByCss(".level-band").filter({ has: name })),
      boxOf(line(level)),
    ]);
    expect(band.right).toBeCloseTo(end.x + end.width / 2, 0);
    expect(text.left).toBeGreaterThanOrEqual(band.left);
    expect(text.right).toBeLessThanOrEqual(band.right + 1);
  }
  const last = page.getByCss(".level-band").filter({ has: page.getByText("Excessive, from 20 Hz") });
  const [band, begin] = await Promise.all([boxOf(last), boxOf(line("Excessive"))]);
  expect(band.left).toBeCloseTo(begin.x + begin.width / 2, 0);
});

test("a new row has the focus and Enter goes on to the next cell and row", async () => {
  const ruler = await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  await ruler.button("Add topic").click();
  await expect.element(page.getByLabelText("Topic of row 2")).toHaveFocus();
  for (const typed of ["/imu", "0.3", "1", "2", "5", "10", "20", "50"]) {
    await commands.type(typed);
    await commands.press("Enter");
  }
  await expect.element(page.getByLabelText("Excessive (Hz) of /imu", { exact: true })).toHaveValue("50");
  await expect.element(page.getByLabelText("Priority of /imu")).toHaveFocus();
  await commands.press("Enter");
  await commands.press("Enter");
  await expect.element(page.getByLabelText("Topic of row 3")).toHaveFocus();
});

test("names of topics are told apart on a telephone", async () => {
  await resize(390, 844);
  const topic = (name: string) => `[topics."/camera/image_raw${name}"]\nmessage_kb = 1\n`;
  await openPage("radio", { files: { "radio.toml": topic("") + topic("/compressed") } });
  await page.getByRole("link", { name: "radio.toml" }).click();
  await expect.element(page.getByLabelText("Topic of row 2")).toBeVisible();
  const fields = [...document.querySelectorAll<HTMLInputElement>("input.topic")];
  expect(fields.map(({ scrollWidth, clientWidth }) => scrollWidth <= clientWidth)).toEqual([true, true]);
});

test("measuring shows how far it is and Cancel leaves the table as it was", async () => {
  const ruler = await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  const release = ruler.network.hold("POST /api/profile/measure");
  const choice = page.getByLabelText("Measure in");
  await choice.selectOptions("monday");
  await expect.element(page.getByRole("progressbar", { name: "Measuring" })).toBeVisible();
  await expect.element(choice).not.toBeInTheDocument();
  await ruler.button("Cancel").click();
  await expect.element(page.getByText("Cancelled.")).toBeVisible();
  release();
  await expect.element(cellOf("Desirable")).toHaveValue("10");
  await choice.selectOptions("monday");
  await expect.element(page.getByLabelText("Topic of row 2")).toBeVisible();
});

test.each([1440, 1280, 900])("the button that removes a topic is whole at every width: %i", async (width) => {
  await resize(width, 800);
  const ruler = await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  const button = await boxOf(ruler.button("Remove /odom"));
  const table = await boxOf(page.getByCss(".table-scroll"));
  expect(innerWidth).toBe(width);
  expect(button.right).toBeLessThan(table.right);
});

test("levels that fall are refused in words", async () => {
  const ruler = await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  await cellOf("Desirable").fill("3");
  const problems = page.getByRole("list", { name: "Problems" });
  await expect.element(problems).toHaveTextContent("Desirable (3 Hz) is below Acceptable (5 Hz)");
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  await cellOf("Desirable").fill("6");
  await expect.element(problems.getByRole("listitem")).not.toBeInTheDocument();
  await expect.element(await ruler.tool("Save")).toBeEnabled();
});

test("the curve of a recording proposes levels with one click", async () => {
  const ruler = await openPage("radio");
  await page.getByRole("link", { name: "radio.toml" }).click();
  await page.getByRole("combobox", { name: "Recording" }).selectOptions("monday");
  await ruler.button("Show what each rate loses").click();
  await page.getByText("The curve as numbers").click();
  await expect.element(page.getByRole("row").filter({ hasText: "pose_y" }).first()).toBeVisible();
  await ruler.button("Use the proposed levels").click();
  await expect.element(line("Excessive")).toHaveAttribute("aria-valuetext", "25 Hz");
  await ruler.use("Save");
  await expect.element(page.getByText("Saved radio.toml")).toBeVisible();
  const tiers =
    /tiers_hz = \[(.*)\]/
      .exec(await ruler.saved("radio.toml"))?.[1]
      ?.split(", ")
      .map(Number) ?? [];
  expect(tiers).toHaveLength(6);
  expect(tiers).toEqual([...tiers].sort((one, other) => one - other));
  expect(tiers.at(-1)).toBe(25);
  const shown = ["Unacceptable", "Competitive"].map((level) => line(level).element().getAttribute("aria-valuenow"));
  expect(shown.map(Number)).toEqual([tiers[0], tiers[4]]);
});

function line(level: string): Locator {
  return page.getByRole("slider", { name: `${level} level of /odom (Hz)`, exact: true });
}

function cellOf(level: string): Locator {
  return page.getByLabelText(`${level} (Hz) of /odom`, { exact: true });
}

/** Waits until the levels stand on the axis, which is drawn a picture after they are there. */
async function awaitAxis(): Promise<void> {
  await expect.poll(() => document.querySelector(".level-area")?.clientWidth).toBeGreaterThan(0);
}

async function dragLine(found: Locator, rightPx: number): Promise<void> {
  await awaitAxis();
  const { x: left, width, bottom } = await boxOf(found);
  const [x, y] = [left + width / 2, bottom - 20];
  await commands.mouseMove(x, y);
  await commands.mouseDown();
  await commands.mouseMove(x + rightPx, y, 5);
  await commands.mouseUp();
}
