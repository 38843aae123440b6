// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { render } from "preact";
import { expect } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { Api } from "../../src/api/client";
import type { SaveRequest } from "../../src/api/types";
import { App } from "../../src/app";
import { RobotLink } from "../../src/state/robot_link";
import { RobotProvider } from "../../src/ui/connection";
import { type Files, serverOf } from "./answers";
import { Network } from "./network";

/** From the corner of a block to where it is taken: beside its fields. */
export const GRIP_PX = 9;

/** The page asks nothing more so long after what was done. */
const QUIET_MS = 2000;

/** The browser's word for a size that is told of with the next picture, which is no fault. */
const LATER_SIZE = "ResizeObserver loop completed with undelivered notifications";

export interface Opening {
  /** Files beside those of the project, or null for one that is not there. */
  files?: Files;
  /** The address after the page's, as `#/rules/warehouse.adirf`; the home screen without. */
  hash?: string;
  /** Whether somebody opens it for the first time, and is offered a tour. */
  isNew?: boolean;
  /** Whether they may change neither files nor robots. */
  onlyWatches?: boolean;
  /** Whether nobody unfolded anything beside the blocks; else text and findings are open. */
  isFolded?: boolean;
}

let opened: RulerPage | null = null;

/** Opens the page in a project of tests/ruler/page_projects.py. */
export async function openPage(project: string, opening: Opening = {}) {
  const { files = {}, hash = "", isNew = false, onlyWatches = false, isFolded = false } = opening;
  const { currentTestName: test = "", testPath = "" } = expect.getState();
  const file = testPath.replace(/^.*\/|\.test\.tsx$/g, "");
  if (!isNew) localStorage.setItem("tour", "seen");
  if (!isFolded) localStorage.setItem("open panes", "text findings");
  const server = await serverOf({ file, test, project, files });
  const network = new Network(server);
  network.greeting = network.greeting.map((push) =>
    push.kind === "hello" ? { ...push, only_watches: onlyWatches } : push,
  );
  opened = new RulerPage(network, server);
  await opened.mount(hash);
  return opened;
}

/** Closes the page of a test; returns what it complained about. */
export async function closePage(): Promise<string[]> {
  const complaints = (await opened?.close()) ?? [];
  opened = null;
  return complaints;
}

/** The page, and what somebody does in it. */
export class RulerPage {
  readonly complaints: string[] = [];
  private host: HTMLElement | null = null;
  private link: RobotLink | null = null;
  private readonly own = { error: console.error, warn: console.warn };

  constructor(
    readonly network: Network,
    private readonly server: { write(files: Files): Promise<void>; end(): Promise<void> },
  ) {
    for (const kind of ["error", "warn"] as const)
      console[kind] = (...said: unknown[]) => {
        const words = said.map(String).join(" ");
        if (!words.includes(LATER_SIZE)) this.complaints.push(words);
      };
    network.open();
  }

  async mount(hash: string): Promise<void> {
    history.replaceState(null, "", location.pathname + location.search + hash);
    this.host = document.createElement("div");
    this.host.id = "app";
    document.body.append(this.host);
    // As in a page that was just loaded, Tab leads to what comes first in it.
    this.host.tabIndex = -1;
    this.host.focus();
    this.host.removeAttribute("tabindex");
    this.link = new RobotLink();
    this.link.open();
    render(
      <RobotProvider value={this.link}>
        <App api={new Api()} />
      </RobotProvider>,
      this.host,
    );
    if (hash === "") await this.shown(this.button("New Rule File"));
  }

  unmount(): void {
    if (this.host === null) return;
    render(null, this.host);
    this.host.remove();
    this.host = null;
    this.network.leavePage();
  }

  /** Loads the page anew. */
  async reload(): Promise<void> {
    const { hash } = location;
    this.unmount();
    await this.mount(hash);
  }

  async close(): Promise<string[]> {
    // What a fast page asks before the test ends, a slow one asks a moment later.
    if (await commands.isRecording()) await new Promise((done) => setTimeout(done, QUIET_MS));
    this.unmount();
    await this.network.close();
    await this.server.end();
    // With its next pictures a page that closed a dialog gives the focus to what is there then.
    await twoPictures();
    Object.assign(console, this.own);
    return [...this.network.complaints, ...this.complaints];
  }

  /** Drops complaints that hold `words`, of which there must be some. */
  forgive(words: string): void {
    const kept = this.complaints.filter((each) => !each.includes(words));
    expect(kept.length).toBeLessThan(this.complaints.length);
    this.complaints.splice(0, Number.POSITIVE_INFINITY, ...kept);
  }

  /** Loads the home screen anew. */
  async home(): Promise<void> {
    this.unmount();
    await this.mount("");
  }

  /** Somebody else writes files, or removes those that are null. */
  write(files: Files): Promise<void> {
    return this.server.write(files);
  }

  /** Somebody else writes files, which the page sees when it saves and not before, however slow the test is. */
  async saveOver(files: Files, save = () => this.use("Save")): Promise<void> {
    const release = this.network.hold("GET /api/file/state", `name=${Object.keys(files)[0]}`);
    await this.write(files);
    const answered = this.network.answered("PUT /api/file");
    await save();
    await answered;
    release();
  }

  /** The text that the page saves next, or saved last, into a file. */
  async saved(name: string): Promise<string> {
    const last = () => this.network.asked.filter(({ ask, body }) => ask === "PUT /api/file" && of(body).name === name);
    const of = (body: unknown) => body as SaveRequest;
    await expect.poll(() => last().length).toBeGreaterThan(0);
    return of(last().at(-1)?.body).text;
  }

  button(name: string): Locator {
    return page.getByRole("button", { name, exact: true });
  }

  /** What unfolds beside or below the blocks. */
  pane(name: string): Locator {
    return page.getByRole("group", { name: "Unfold" }).getByRole("button", { name, exact: true });
  }

  /** Unfolds that, where it is not open. */
  async openPane(name: string): Promise<void> {
    const button = await this.pane(name).findElement();
    if (button.getAttribute("aria-expanded") === "false") await this.pane(name).click();
  }

  /** Opens what each topic takes of the budget. */
  async openRates(): Promise<void> {
    await page.getByRole("button", { name: /^Budget …|KB\/s$/ }).click();
    await this.shown(page.getByRole("dialog", { name: "Rates within the budget" }));
  }

  /** What the bar on top calls `name`: a button, or an entry of its menu, which is opened for it. */
  async tool(name: string): Promise<Locator> {
    const bar = page.getByRole("toolbar", { name: "Tools" });
    const menu = bar.getByRole("button", { name: "Menu", exact: true });
    await this.shown(menu);
    const button = bar.getByRole("button", { name, exact: true });
    if (button.length > 0) return button;
    if (menu.element().getAttribute("aria-expanded") === "false") await menu.click();
    return bar.getByRole("menuitem", { name, exact: true });
  }

  /** Clicks what the bar on top calls so. */
  async use(name: string): Promise<void> {
    await (await this.tool(name)).click();
  }

  get text(): Locator {
    return page.getByRole("textbox", { name: "Rules as text" });
  }

  get blocks(): Locator {
    return page.getByRole("region", { name: "Blocks", exact: true });
  }

  /** Opens a file from the home screen. */
  async open(name: string): Promise<void> {
    await page.getByRole("link", { name, exact: true }).click();
    await this.shown(this.blocks);
  }

  /** The lowest field or button on the blocks whose label starts so, as in `Edit value: 0`. */
  async field(label: string): Promise<Locator> {
    const start = new RegExp(`^${label.replace(/[.*+?^${}()|[\]\\/]/g, "\\$&")}`);
    return lowest(this.blocks.getByRole("button", { name: start }));
  }

  /**
   * Clicks the lowest field with this label, types, presses Enter, and sees the value on the block.
   * A field that a new block opened by itself is not clicked again.
   */
  async change(label: string, value: string): Promise<void> {
    const kind = label.split(":", 1)[0] as string;
    if (!this.isOpen(kind)) await (await this.field(label)).click();
    await this.typeValue(value);
    await this.shown(this.blocks.getByRole("button", { name: `${kind}: ${value}`, exact: true }).first());
  }

  /** Whether the field that is called `Edit value` is open to type into. */
  isOpen(kind: string): boolean {
    const named = page.getByLabelText(kind.replace(/^Edit /, ""), { exact: true }).elements();
    return named.some((each) => each.matches("input:focus"));
  }

  /** Types into the field that is open. */
  async typeValue(value: string): Promise<void> {
    await commands.press("Control+a");
    await commands.type(value);
    await commands.press("Enter");
  }

  /** Focuses a thing and presses keys, as `ArrowDown` or `Control+a`. */
  async press(target: Locator, ...keys: string[]): Promise<void> {
    ((await target.findElement()) as HTMLElement).focus();
    await commands.press(...keys);
  }

  /** What a screen reader calls the focused thing; nothing where that is the whole page. */
  get focused(): string {
    const { activeElement } = document;
    if (activeElement === null || activeElement === document.body) return "";
    return activeElement.getAttribute("aria-label") || (activeElement.textContent ?? "");
  }

  /** Waits until the focus is on what is called something with these words. */
  async awaitFocus(words: string): Promise<void> {
    await expect.poll(() => this.focused).toContain(words);
  }

  /** Presses `key` until the focus is on what is called `name`. */
  async walk(key: string, name: string, steps = 60): Promise<void> {
    for (let step = 0; step < steps; step++) {
      await commands.press(key);
      if (this.focused.includes(name)) return;
    }
    expect(this.focused, `where ${key} leads`).toContain(name);
  }

  /** The text holds these lines in this order, whatever stands between them. */
  async expectLines(...lines: string[]): Promise<void> {
    const escaped = lines.map((line) => line.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
    await expect.element(this.text).toHaveTextContent(new RegExp(escaped.join("[\\s\\S]*")));
  }

  /** Drags `block` by its edge to beside the left end of the lower edge of `target`. */
  async drag(block: Locator, target: Locator, rightPx: number, belowPx: number): Promise<void> {
    await block.hover({ position: { x: GRIP_PX, y: GRIP_PX } });
    const { left, bottom } = await boxOf(target);
    const [x, y] = [left + GRIP_PX + rightPx, bottom + GRIP_PX + belowPx];
    await commands.mouseDown();
    await commands.mouseMove(x, y, 12);
    // What a place on the way made room for closes first.
    await commands.mouseMove(x + 1, y);
    await commands.mouseUp();
  }

  async save(): Promise<void> {
    await this.use("Save");
    await expect.element(await this.tool("Save")).toBeDisabled();
  }

  /** Waits until something is to be seen. */
  async shown(found: Locator): Promise<void> {
    await expect.element(found).toBeVisible();
  }
}

/** Where something is on the page, once it is there. */
export async function boxOf(found: Locator): Promise<DOMRect> {
  return (await found.findElement()).getBoundingClientRect();
}

/** The lowest of these, once there are some; what got the focus just now goes behind the others with the next picture. */
export async function lowest(found: Locator): Promise<Locator> {
  await found.first().findElement();
  await twoPictures();
  const topsPx = found.elements().map((each) => each.getBoundingClientRect().top);
  return found.nth(Math.max(0, topsPx.indexOf(Math.max(...topsPx))));
}

/** What is typed into an input. */
export function typedIn(found: Locator): string {
  return (found.element() as HTMLInputElement).value;
}

/** Gives the screen another size; each test begins with the usual one. */
export async function resize(width: number, height: number): Promise<void> {
  // Vitest scales the test's frame into the page around it, which has the size that the last test gave it.
  const isOther = await commands.resize(width, height);
  if (isOther || innerWidth !== width || innerHeight !== height) await page.viewport(width, height);
}

export function twoPictures(): Promise<void> {
  return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())));
}
