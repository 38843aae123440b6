// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { violations } from "./axe";
import { openPage, type RulerPage, resize } from "./ruler_page";

const RULES = `\
begin
    SetFrequency /odom 5
    SetFrequency /image 0.25
    Rule "Far"
    If (CheckValue /odom pose_y > 2)
    Then
        SetFrequency /scan 1
    EndIf
end
`;
const RUN = "Run the rules on them";
const TRY = "POST /api/try/headline";

test("a run goes on with its rules and keeps what is done where it is cancelled", async () => {
  const ruler = await openRuns();
  let release = ruler.network.hold(TRY, "runs/b_long");
  await ruler.button(RUN).click();
  await expect.poll(() => rows().length).toBe(2);
  await ruler.text.getByText("SetFrequency /odom 5").click();
  await commands.press("End", "0");
  const stale = page.getByText("Stale: rules changed since.");
  await expect.element(stale).toHaveTextContent("This run goes on with the rules and recordings that it began with.");
  release();
  await expect.poll(() => rows().length).toBe(4);
  await expect.element(stale).toHaveTextContent("Run the rules again to see what they do now.");
  const tried = ruler.network.asked.filter(({ ask }) => ask === TRY);
  expect(tried).toHaveLength(4);
  for (const { body } of tried) expect(JSON.stringify(body)).toContain("/odom 5\\n");

  release = ruler.network.hold(TRY, "runs/b_long");
  await ruler.button(RUN).click();
  await expect.element(progress()).toHaveTextContent("1 of 4");
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.open("far.adirf");
  await ruler.openPane("Try on a recording");
  await ruler.button("Cancel").click();
  release();
  await expect.element(page.getByText("Cancelled.", { exact: true })).toBeVisible();
  await expect
    .element(progress())
    .toHaveTextContent(
      /^1 of 4 recordings of runs\/ tried\. The others were not: it was ended before\. What was tried stays\.$/,
    );
  expect(names()).toEqual(["a_short"]);
  await expect.element(page.getByText("Stale:")).not.toBeInTheDocument();
});

test("a telephone tries a folder", async () => {
  await resize(390, 844);
  const ruler = await openRuns();
  await ruler.button(RUN).click();
  await expect.poll(() => rows().length).toBe(4);
  expect(document.documentElement.scrollWidth).toBeLessThanOrEqual(innerWidth);
  expect(await violations()).toEqual([]);
  // Anywhere in a row is as good as on its name, which is over all of it.
  await rows().filter({ hasText: "d_middle" }).getByRole("cell").nth(1).click({ force: true });
  await expect.element(page.getByText("The rules decided")).toBeVisible();
});

/** The page before the rules are tried on all recordings of a folder. */
async function openRuns(): Promise<RulerPage> {
  const ruler = await openPage("runs", { files: { "far.adirf": RULES } });
  await ruler.open("far.adirf");
  await ruler.openPane("Try on a recording");
  await page.getByRole("combobox", { name: "Recording" }).selectOptions("runs/: all 4 recordings");
  return ruler;
}

/** The rows with numbers, the total last. */
function rows(): Locator {
  const table = page.getByRole("table", { name: "Recordings" });
  return table.getByRole("row").filter({ has: page.getByRole("rowheader") });
}

function names(): (string | null)[] {
  const heads = rows().getByRole("rowheader").elements();
  return heads.map((each) => each.textContent).slice(0, -1);
}

function progress(): Locator {
  return page.getByRole("status").filter({ hasText: /^\d+ of \d+ recordings/ });
}
