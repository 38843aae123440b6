// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test, vi } from "vitest";
import { commands, page } from "vitest/browser";
import type { HealthWords, RobotSummary } from "../../src/api/types";
import { violations } from "./axe";
import { openPage, type RulerPage, resize } from "./ruler_page";

const FILES = { "patrol.adirf": "begin\n    SetFrequency /odom 10\nend\n" };
const PLACES = ["Rules", "Topics", "Robots", "Incidents", "Recordings", "Help"];

function robot(label: string, changes: Partial<RobotSummary> = {}): RobotSummary {
  return {
    ...{ node: `${label}:/smarttestudo`, label, is_heard: true, heard_s_ago: 0.2, health: null, topics: 3 },
    rules: { files: ["/etc/testudo/patrol.adirf"], sha256: "0f".repeat(32), origin: "files", waits_s: null },
    ...{ budget_kb_per_s: 100, out_kb_per_s: 60, link: null, recorded: 0 },
    ...changes,
  };
}

function bad(summary: string, level: HealthWords["level"] = "error"): HealthWords {
  return { level, summary, message: `${summary}: more of it` };
}

const GONE = robot("dave", { is_heard: false, heard_s_ago: 2820, health: bad("silent for 47 min") });
const SOURCELESS = robot("ada", { health: bad("no publisher") });
const LATE = robot("bob", { health: bad("late", "warn") });
const FINE = robot("eve");

async function openWith(hash: string, ...robots: RobotSummary[]): Promise<RulerPage> {
  vi.stubGlobal("open", () => null);
  const ruler = await openPage("empty", { files: FILES, hash });
  tell(ruler, ...robots);
  return ruler;
}

function tell(ruler: RulerPage, ...robots: RobotSummary[]): void {
  const push = { kind: "robots", problem: null, robots } as const;
  ruler.network.greeting = [...ruler.network.greeting.filter(({ kind }) => kind !== "robots"), push];
  ruler.network.tell(push);
}

const rows = () => page.getByRole("table", { name: "Robots" }).getByRole("row");
const colourOf = (variable: string) => {
  const probe = document.body.appendChild(document.createElement("i"));
  probe.style.color = `var(${variable})`;
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
};
const colourIn = (words: string) => getComputedStyle(rows().getByText(words).element()).color;

test("a robot whose sources are all dead is red in its row, in the bar and in the tab's title", async () => {
  const ruler = await openWith("#/robots/", SOURCELESS, LATE, FINE);
  await ruler.shown(page.getByText("3 robots, 2 with trouble"));
  await expect.element(rows().nth(1)).toHaveTextContent(/ada.*no publisher: more of it/);
  expect(colourIn("no publisher: more")).toBe(colourOf("--error"));
  expect(colourIn("late: more")).toBe(colourOf("--warning"));
  const pill = page.getByRole("button", { name: "ada: no publisher" });
  expect(getComputedStyle(pill.element()).color).toBe(colourOf("--error"));
  await expect.poll(() => document.title).toBe("✕ ada: no publisher · ADIRF Ruler");
  tell(ruler, LATE, FINE);
  await expect.poll(() => document.title).toBe("ADIRF Ruler");
});

test("a robot that was silent for long stays in red with when it was heard last until somebody removes it", async () => {
  const ruler = await openWith("#/robots/", GONE, FINE);
  await expect.element(rows().nth(1)).toHaveTextContent(/dave.*silent for 47 min.*47 min ago/);
  expect(colourIn("silent for 47 min: more")).toBe(colourOf("--error"));
  await expect.poll(() => document.title).toContain("✕ dave: silent for 47 min");
  await expect.element(page.getByRole("button", { name: "Remove eve" })).not.toBeInTheDocument();
  ruler.network.replace("POST /api/robot/remove", { status: 200, json: { node: GONE.node } });
  await page.getByRole("button", { name: "Remove dave" }).click();
  await expect
    .poll(() => ruler.network.asked.at(-1))
    .toEqual({
      ask: "POST /api/robot/remove",
      body: { node: "dave:/smarttestudo" },
    });
});

test("ten robots can be narrowed to those with trouble, fewer cannot", async () => {
  const ruler = await openWith("#/robots/", GONE, FINE);
  await expect.element(page.getByLabelText("Only those with trouble")).not.toBeInTheDocument();
  tell(ruler, GONE, ...Array.from({ length: 9 }, (_, place) => robot(`r${place}`)));
  await page.getByLabelText("Only those with trouble").click();
  await expect.poll(() => rows().length).toBe(2);
});

test("axe finds nothing on robots that are well or not, at all widths", async () => {
  await openWith("#/robots/", GONE, SOURCELESS, LATE, FINE);
  await expect.poll(() => rows().length).toBe(5);
  expect(await violations()).toEqual([]);
});

test("each place is in the rail, by keyboard, also on a telephone", async () => {
  await openWith("#/", FINE);
  const rail = page.getByRole("navigation", { name: "Places" });
  await expect.element(rail).toBeVisible();
  expect(
    rail
      .getByRole("link")
      .elements()
      .map((each) => each.textContent),
  ).toEqual(PLACES);
  await expect.element(rail.getByRole("link", { name: "Rules" })).toHaveAttribute("aria-current", "page");
  await commands.press("Tab");
  for (let place = 0; place < 3; place++) await commands.press("Tab");
  await expect.element(rail.getByRole("link", { name: "Robots" })).toHaveFocus();
  await commands.press("Enter");
  await expect.element(page.getByRole("heading", { level: 1 })).toHaveTextContent("Robots");
  await expect.element(rail.getByRole("link", { name: "Robots" })).toHaveAttribute("aria-current", "page");
  await resize(390, 844);
  for (const each of rail.getByRole("link").elements()) {
    const { top, bottom, left, right } = each.getBoundingClientRect();
    expect([top > 700, bottom <= 844, left >= 0, right <= 390]).toEqual([true, true, true, true]);
  }
});

test("a project with 65 incidents has a first screen of rule files alone", async () => {
  const incidents = Array.from({ length: 65 }, (_, place) => [`inc/2026-${place}.mcap`, "no recording"]);
  await openPage("empty", { files: { ...FILES, ...Object.fromEntries(incidents) } });
  const main = page.getByRole("main");
  await expect.element(main.getByRole("link", { name: "patrol.adirf" })).toBeVisible();
  expect(
    main
      .getByRole("button")
      .elements()
      .map((each) => each.getAttribute("aria-label") ?? each.textContent),
  ).toEqual(["New Rule File", "More for patrol.adirf"]);
  expect(document.documentElement.scrollHeight).toBeLessThanOrEqual(innerHeight);
});

test("a file's name and notes stand on one line, and what can be done with it covers no other file", async () => {
  const many = Object.fromEntries(Array.from({ length: 12 }, (_, place) => [`r${place}.adirf`, "begin\nend\n"]));
  const ruler = await openWith("#/", FINE, SOURCELESS);
  await ruler.write(many);
  dispatchEvent(new Event("focus"));
  const entry = page.getByRole("listitem").filter({ hasText: "patrol.adirf" });
  await expect.element(entry).toHaveTextContent(/patrol\.adirf.*on eve.*on ada/);
  const [name, notes] = [".file-name", ".file-notes"].map((one) => entry.element().querySelector(one) as Element);
  const middle = (each: Element | undefined) => {
    const { top = 0, bottom = 0 } = each?.getBoundingClientRect() ?? {};
    return (top + bottom) / 2;
  };
  expect(Math.abs(middle(name) - middle(notes))).toBeLessThan(2);
  await expect.element(page.getByRole("link", { name: "r11.adirf" })).toBeInTheDocument();
  const before = page.getByRole("main").element().getBoundingClientRect().height;
  await ruler.button("More for r11.adirf").click();
  await expect.element(page.getByRole("menuitem", { name: "Rename" })).toHaveFocus();
  expect(page.getByRole("main").element().getBoundingClientRect().height).toBe(before);
  await commands.press("Escape");
  await expect.element(ruler.button("More for r11.adirf")).toHaveFocus();
});

test("axe finds nothing on the first screen, at all widths", async () => {
  await openWith("#/", FINE, SOURCELESS);
  await expect.element(page.getByText("on eve")).toBeVisible();
  expect(await violations()).toEqual([]);
});
