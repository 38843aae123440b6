// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { page } from "vitest/browser";
import { boxOf, openPage, resize } from "./ruler_page";

const SHELF = `\
begin
    Rule "Shelf"
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
/** A text that is no pattern is found in any case: `Not everything fits into` has it, too. */
const FITS = /^Everything fits into/;
const REDUCE = "Optimize and Download";

test("what does not fit is explained and mended with one click", async () => {
  const ruler = await openPage("thesis", { files: { "shelf.adirf": SHELF } });
  await ruler.open("shelf.adirf");
  await ruler.use(REDUCE);
  await expect.element(page.getByRole("alert")).toHaveTextContent(/needs at least 157\s665\.72 KB\/s/);
  await expect.element(ruler.button("Download")).toBeDisabled();
  await page.getByRole("alert").getByRole("button").first().click();
  await expect.element(page.getByText(FITS)).toBeVisible();
  await expect.element(ruler.button("Download")).toBeEnabled();
});

test("a rule file opens with the topic parameters that fit it or were chosen for it", async () => {
  const table = (topics: string[]) =>
    "budget_kb_per_s = 100\n" +
    topics.map((topic) => `[topics."${topic}"]\nmessage_kb = 1\ntiers_hz = [1, 2, 3, 4, 5, 6]\n`).join("");
  const tables = { "arm.toml": table(["/joints"]), "base.toml": table(["/imu", "/camera/image_raw"]) };
  const ruler = await openPage("examples", { files: { "shelf.adirf": SHELF, ...tables } });
  await ruler.open("shelf.adirf");
  const choice = page.getByRole("combobox", { name: "Topic parameters" });
  await expect.element(choice).toHaveValue("base.toml");

  let chosen = ruler.network.answered("PUT /api/profile/for");
  await choice.selectOptions("arm.toml");
  await chosen;
  await ruler.use(REDUCE);
  const refused = page.getByText("/imu is in the rules but not in the chosen profile");
  await expect.element(refused).toHaveTextContent("Add a row for /imu to its table");
  await ruler.home();
  await ruler.open("shelf.adirf");
  await expect.element(choice).toHaveValue("arm.toml");
  chosen = ruler.network.answered("PUT /api/profile/for");
  await choice.selectOptions("none");
  await chosen;
  await ruler.home();
  await ruler.open("shelf.adirf");
  await expect.element(choice).toHaveValue("");
  await page.getByRole("link", { name: "Create" }).click();
  await expect.element(page.getByText("shelf.toml, new, not saved")).toBeVisible();
});

test("a reduction of very many topics stays on the page", async () => {
  const topics = Array.from(
    { length: 60 },
    (_, at) => `/robot/sensors/number_${`${at}`.padStart(2, "0")}/measurements`,
  );
  const entries = topics.map((topic) => `[topics."${topic}"]\nmessage_kb = 10\ntiers_hz = [1, 2, 5, 10, 20, 50]\n`);
  const rates = topics.map((topic) => `    SetFrequency ${topic} Competitive\n`);
  const files = {
    "many.toml": `budget_kb_per_s = 700\n${entries.join("")}`,
    "many.adirf": `begin\n${rates.join("")}end\n`,
  };
  await resize(1280, 800);
  const ruler = await openPage("examples", { files });
  await ruler.open("many.adirf");
  await ruler.use(REDUCE);
  const repair = page.getByRole("alert").getByRole("button").first();
  (await repair.findElement()).scrollIntoView({ block: "nearest" });
  const box = await boxOf(repair);
  expect(box.right).toBeLessThanOrEqual(1280);
  expect(box.height).toBeLessThan(200);
  expect(document.querySelector("dialog")?.scrollWidth).toBeLessThanOrEqual(1280);
  await repair.click();
  await expect.element(page.getByText(FITS)).toBeVisible();
});

test("all that does not fit is repaired at once", async () => {
  const entry = (topic: string) => `[topics."${topic}"]\nmessage_kb = 10\ntiers_hz = [1, 2, 5, 10, 20, 50]\n`;
  const rule = (number: number) =>
    `    Rule "${number}" If CheckValue /odom pose_x > ${number}0 Then SetFrequency /scan Excessive\n`;
  const files = {
    "two.toml": `budget_kb_per_s = 120\n${entry("/odom")}${entry("/scan")}`,
    "two.adirf": `begin\n    SetFrequency /odom Competitive\n    SetFrequency /scan Marginal\n${rule(1)}${rule(2)}end\n`,
  };
  const ruler = await openPage("examples", { files });
  await ruler.open("two.adirf");
  await ruler.use(REDUCE);
  await expect.element(page.getByText("Not everything fits into")).toBeVisible();
  await ruler.button("Repair all 2").click();
  await expect.element(page.getByText(FITS)).toBeVisible();
  await ruler.button("Cancel").click();
  await ruler.use("Undo");
  await expect.poll(() => document.querySelector(".budget-bar.over")).not.toBeNull();
});

test("an empty file says what to do first and no button is coloured", async () => {
  const ruler = await openPage("examples", { files: { "new.adirf": "begin\nend\n" } });
  await ruler.open("new.adirf");
  await expect.element(page.getByText("Begin with New rate")).toBeVisible();
  const coloured = page.getByCss("button.primary:visible");
  await expect.poll(() => coloured.length).toBe(0);
  await ruler.button("New rate").click();
  await expect.poll(() => coloured.length).toBe(1);
});

test("the table starts with the topics of the rules and leads back", async () => {
  const aisle = "begin\n    SetFrequency /lift 5\n    SetFrequency /fork 2\nend\n";
  const ruler = await openPage("examples", { files: { "aisle.adirf": aisle } });
  await ruler.open("aisle.adirf");
  await page.getByLabelText("Topic parameters").selectOptions("none");
  await page.getByRole("link", { name: "Create" }).click();
  await expect.element(page.getByLabelText("Topic of row 1")).toHaveValue("/fork");
  await expect.element(page.getByLabelText("Topic of row 2")).toHaveValue("/lift");
  await expect.element(page.getByText("aisle.toml, new, not saved")).toBeVisible();
  await page.getByRole("button", { name: "Remove /lift" }).click();
  await expect.element(page.getByText("1 topic of the rules is not in the table.")).toBeVisible();
  await ruler.button("Add /lift").click();
  await expect.element(page.getByLabelText("Topic of row 2")).toHaveValue("/lift");
  await page.getByLabelText("Message size (KB) of /lift").fill("0.5");
  // Once the table is saved it becomes that of the rules, for which none was chosen above.
  const chosen = ruler.network.answered("PUT /api/profile/for");
  await ruler.save();
  await chosen;
  await page.getByRole("link", { name: "Back to aisle.adirf" }).click();
  await expect.element(page.getByLabelText("Topic parameters")).toHaveValue("aisle.toml");
  await ruler.expectLines("SetFrequency /lift 5");
});

test("from the first screen a new table is for the only rules", async () => {
  const ruler = await openPage("empty", { files: { "aisle.adirf": "begin\n    SetFrequency /lift 5\nend\n" } });
  await page.getByRole("link", { name: "Topics", exact: true }).click();
  await expect.element(page.getByLabelText("Topic of row 1")).toHaveValue("/lift");
  await expect.element(page.getByText("aisle.toml, new, not saved")).toBeVisible();
  await expect.element(page.getByRole("link", { name: "Back to aisle.adirf" })).toBeVisible();
  // Nobody changed anything yet: nothing is restored, and the table can be saved as it is.
  await ruler.reload();
  await expect.element(page.getByLabelText("Topic of row 1")).toHaveValue("/lift");
  await expect.element(page.getByText("unsaved changes")).not.toBeInTheDocument();
  await ruler.save();
  expect(await ruler.saved("aisle.toml")).toContain("/lift");
});
