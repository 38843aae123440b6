// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { openPage, type RulerPage } from "./ruler_page";

const RULES = "begin\n    SetFrequency /odom 10\n    SetFrequency /odom 5\nend\n";
const TABLE = 'budget_kb_per_s = 8000\n\n[topics."/odom"]\nmessage_kb = 0.72\nsource_hz = 25.5\n';
const SINCE = /has not answered since \d\d:\d\d\./;
const AS_OF = /^As of \d\d:\d\d/;

test("all is read and checked again when the server is back", async () => {
  const ruler = await openRules();
  const errors = page.getByRole("list", { name: "Findings" }).getByText("Error", { exact: true });
  await endServer(ruler);
  await ruler.text.getByText("SetFrequency /odom 10").click();
  await commands.press("End", "Enter");
  await commands.type("SetFrequenzy /scan 3");
  await ruler.write({ "other.adirf": RULES });
  ruler.network.cut(false);
  await expect.element(banner()).not.toBeInTheDocument();
  await expect.poll(() => errors.length).toBe(1);
  await expect.element(page.getByText(AS_OF)).not.toBeInTheDocument();
  await expect.element(await ruler.tool("Save")).toBeEnabled();
  await page.getByRole("link", { name: "Rules", exact: true }).click();
  await ruler.shown(page.getByRole("link", { name: "other.adirf", exact: true }));
});

test("a file that changed while the server was gone is read again", async () => {
  const ruler = await openRules();
  await endServer(ruler);
  await ruler.write({ "rules.adirf": RULES.replace("/odom 5", "/imu 5") });
  ruler.network.cut(false);
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /imu 5");
  await expect.element(ruler.blocks.getByRole("button", { name: "Edit topic to send: /imu" })).toBeInTheDocument();
});

test.each(["other.adirf", "weak_radio.toml"])(
  "what is opened while the server is gone opens when it is back: %s",
  async (name) => {
    const files = { "other.adirf": RULES, "radio.toml": TABLE, "weak_radio.toml": TABLE };
    const ruler = await openRules(files);
    await ruler.home();
    await endServer(ruler);
    await page.getByRole("link", { name, exact: true }).click();
    const refused = page.getByText("What you typed is kept on this page, and blocks stay as they are");
    await ruler.shown(refused);
    ruler.network.cut(false);
    await ruler.shown(name === "other.adirf" ? ruler.text : page.getByRole("table"));
    await expect.element(refused).not.toBeInTheDocument();
  },
);

test("a file that changes on disk is noticed while it is open", async () => {
  const ruler = await openRules();
  await ruler.write({ "rules.adirf": RULES.replace("/odom 5", "/imu 5") });
  await ruler.shown(page.getByText("rules.adirf was changed elsewhere. Undo brings back"));
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /imu 5");
  await ruler.use("Undo");
  await ruler.expectLines("SetFrequency /odom 10", "SetFrequency /odom 5");
  await ruler.write({ "rules.adirf": RULES.replace("/odom 5", "/scan 5") });
  const notice = page
    .getByRole("status")
    .filter({ hasText: "rules.adirf was changed elsewhere; what you changed here is not saved" });
  await notice.getByRole("button", { name: "Decide" }).click();
  await ruler.button("Keep mine").click();
  await expect.element(notice).not.toBeInTheDocument();
  await ruler.use("Save");
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  expect(await onDisk()).toBe(RULES);
  await ruler.write({ "rules.adirf": null });
  await ruler.shown(page.getByText("rules.adirf is no longer on disk: a save writes it."));
  await ruler.use("Save");
  await ruler.button("Keep mine").click();
  await expect.element(await ruler.tool("Save")).toBeDisabled();
  expect(await onDisk()).toBe(RULES);
});

test("a table that changes on disk is noticed while it is open", async () => {
  const ruler = await openPage("empty", { files: { "radio.toml": TABLE } });
  await page.getByRole("link", { name: "radio.toml", exact: true }).click();
  const size = page.getByLabelText("Message size (KB) of /odom");
  await ruler.shown(size);
  await ruler.write({ "radio.toml": TABLE.replace("0.72", "77.5") });
  await expect.element(size).toHaveValue("77.5");
  await size.fill("3");
  await ruler.write({ "radio.toml": TABLE });
  await ruler.shown(page.getByText("radio.toml was changed elsewhere; what you changed here is not saved"));
  await expect.element(size).toHaveValue("3");
});

test("a table that somebody saves counts in the rules that are open", async () => {
  const ruler = await openRules({ "radio.toml": TABLE });
  await page.getByLabelText("Profile (topic parameters)").selectOptions("radio.toml");
  await ruler.openRates();
  const load = page.getByRole("row").filter({ hasText: "/odom" }).first();
  await expect.element(load).toHaveTextContent("3.6 KB/s");
  await ruler.write({ "radio.toml": TABLE.replace("0.72", "1.44") });
  await expect.element(load).toHaveTextContent("7.2 KB/s");
});

/** A rule file with a warning. */
async function openRules(files = {}): Promise<RulerPage> {
  const ruler = await openPage("empty", { files: { "rules.adirf": RULES, ...files } });
  await ruler.open("rules.adirf");
  await expect.poll(() => ruler.blocks.getByRole("button", { name: "Edit topic to send" }).length).toBe(2);
  return ruler;
}

async function endServer(ruler: RulerPage): Promise<void> {
  ruler.network.cut(true);
  await ruler.shown(banner());
}

function banner(): Locator {
  return page.getByRole("alert").filter({ hasText: SINCE });
}

/** The text that the server has now. */
async function onDisk(): Promise<string> {
  return (await (await fetch("api/file?name=rules.adirf")).json()).text;
}
