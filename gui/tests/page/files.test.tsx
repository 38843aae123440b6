// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, onTestFinished, test, vi } from "vitest";
import { commands, page } from "vitest/browser";
import { openPage } from "./ruler_page";

/** When the files were written, by the server's clock; a save comes a minute later. */
const WRITTEN_MS = 1_700_000_000_000;
const MINUTE_MS = 60_000;
const RULES = "begin\n    SetFrequency /odom 10\nend\n";
const RADIO = "quality/radio.toml";
const FILES = { "zone.adirf": RULES, [RADIO]: '[topics."/odom"]\nmessage_kb = 0.72\n' };

test("all that was deleted can be brought back later", async () => {
  const ruler = await openPage("empty", { files: { ...FILES, "warehouse.adirf": RULES } });
  const names = ["zone.adirf", RADIO] as const;
  for (const name of names) {
    await ruler.button(`More for ${name}`).click();
    await page.getByRole("menuitem", { name: "Delete" }).click();
    await expect.element(page.getByRole("link", { name, exact: true })).not.toBeInTheDocument();
  }
  await ruler.open("warehouse.adirf");
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.shown(page.getByText("quality/radio.toml is deleted, and before it 1 file"));
  await ruler.write({ [RADIO]: "# theirs\n" });
  await ruler.button("Undo").click();
  await expect.element(page.getByRole("alert")).toHaveTextContent("The project has a file of this name");
  await ruler.write({ [RADIO]: null });
  for (const name of [...names].reverse()) {
    await ruler.button("Undo").click();
    await ruler.shown(page.getByRole("link", { name, exact: true }));
  }
  await expect.element(ruler.button("Undo")).not.toBeInTheDocument();
  for (const name of names) {
    const answer = await fetch(`api/file?name=${encodeURIComponent(name)}`);
    expect((await answer.json()).text).toBe(FILES[name]);
  }
});

test.each([`topics/${RADIO}`, "robots/", "incidents/"])(
  "a file that is dropped where nothing takes it leaves the page open: %s",
  async (address) => {
    const ruler = await openPage("empty", { files: FILES, hash: `#/${address}` });
    await ruler.shown(page.getByRole("heading", { level: 1 }));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([RULES], "hall.adirf"));
    const drop = new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
    // The browser is kept from leaving the page for it.
    expect(document.body.dispatchEvent(drop)).toBe(false);
    await ruler.shown(page.getByText("hall.adirf was not taken: drop it on the first screen"));
  },
);

test("the address of a file that is not there leads home", async () => {
  const ruler = await openPage("empty", { files: FILES, hash: "#/rules/gone.adirf" });
  await ruler.shown(page.getByText("project has no gone.adirf"));
  await expect.poll(() => location.hash).toBe("#/");
  await expect.element(page.getByRole("link", { name: "zone.adirf", exact: true })).toBeVisible();
  await expect.element(page.getByRole("link", { name: "gone.adirf" })).not.toBeInTheDocument();
  const { files } = await (await fetch("api/project")).json();
  expect(files.map(({ name }: { name: string }) => name).sort()).toEqual([RADIO, "zone.adirf"]);
  expect(ruler.network.asked.filter(({ ask }) => !ask.startsWith("GET "))).toEqual([]);
});

test("a ROS 1 bag is called that", async () => {
  const ruler = await openPage("empty", { files: { "old.bag": "#ROSBAG V2.0\n" }, hash: "#/recordings/" });
  await ruler.shown(page.getByText("old.bag (ROS 1)"));
  await ruler.button("New rules from old.bag").click();
  const dialog = page.getByRole("dialog", { name: "Start from old.bag" });
  await expect.element(dialog.getByRole("alert")).toHaveTextContent("rosbags-convert --src old.bag --dst old");
});

test("the first tab leads past the places and the header", async () => {
  const ruler = await openPage("empty");
  await commands.press("Tab");
  await expect.element(ruler.button("Skip to the content")).toHaveFocus();
  await commands.press("Enter");
  await expect.element(page.getByRole("heading", { level: 1 })).toHaveFocus();
});

test("an address that changes while the page starts is followed", async () => {
  const change = new MutationObserver(() => {
    if (document.getElementById("app")?.childElementCount === 0) return;
    change.disconnect();
    location.hash = "#/rules/zone.adirf";
  });
  change.observe(document.body, { childList: true, subtree: true });
  onTestFinished(() => change.disconnect());
  const ruler = await openPage("empty", { files: FILES, hash: "#/" });
  await expect.element(ruler.text).toHaveTextContent("SetFrequency /odom 10");
});

test("the list tells what was saved and what others added", async () => {
  vi.setSystemTime(WRITTEN_MS + 1.5 * MINUTE_MS);
  onTestFinished(() => void vi.useRealTimers());
  const ruler = await openPage("empty", { files: FILES });
  const first = page.getByRole("region", { name: "Rules" }).getByRole("listitem").first();
  await expect.element(first).toHaveTextContent(/zone.adirf.*1 minute ago/);
  await ruler.open("zone.adirf");
  await ruler.text.click();
  await commands.type("// Seen again.\n");
  await ruler.save();
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await expect.element(first).toHaveTextContent(/zone.adirf.*just now/);
  await ruler.write({ "of_somebody_else.adirf": RULES });
  dispatchEvent(new Event("focus"));
  await ruler.shown(page.getByRole("link", { name: "of_somebody_else.adirf" }));
});
