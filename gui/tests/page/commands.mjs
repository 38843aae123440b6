// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

/**
 * While answers are recorded each key and each step of the mouse takes so long: the page then asks about all
 * that it may ask about when it is faster.
 */
export const RECORDING_STEP_MS = 500;
const ANSWERS = new URL("./answers/", import.meta.url);

/** The address of the server that answers what was not recorded, once it was asked. */
let server;

/** Where this file put the mouse of each page. */
const mice = new WeakMap();

/** What the page's tests have done outside of their document: by the browser's driver, or on the disk. */
export const commands = {
  /** The recorded answers of a test file, null where there are none. */
  recordedAnswers(_, file) {
    const path = new URL(`${file}.json`, ANSWERS);
    return existsSync(path) ? readFileSync(path, "utf-8") : null;
  },

  isRecording,

  /** Has the recorder (scripts/make_page_answers.py) do something, and returns what it answers. */
  async recorder(_, act, said) {
    const answer = await fetch(`${process.env.PAGE_RECORDER}/${act}`, { method: "POST", body: JSON.stringify(said) });
    if (!answer.ok) throw new Error(`the recorder does not ${act}`);
    return answer.json();
  },

  /**
   * What a real server of an empty project answers: which edits are sent together, and so which texts are asked
   * about, depends on the machine.
   */
  async askServer(_, ask, body) {
    server ??= startedServer();
    const [method, path] = ask.split(" ");
    const url = await server;
    const headers = { "Content-Type": "application/json", Origin: url };
    const answer = await fetch(new URL(path, url), { method, headers, body: JSON.stringify(body) });
    return { status: answer.status, json: await answer.json() };
  },

  /** Gives the whole page a size, which vitest gives to the test's frame only; whether it had another. */
  async resize({ page }, width, height) {
    const before = page.viewportSize();
    const isOther = before.width !== width || before.height !== height;
    if (isOther) await page.setViewportSize({ width, height });
    return isOther;
  },

  /** Whether the browser's user wants no motion: `reduce`, as each test begins, or `no-preference`. */
  emulateMotion: ({ page }, reducedMotion) => page.emulateMedia({ reducedMotion }),

  /** Whether the screen is light or dark. */
  colorScheme: ({ page }, colorScheme) => page.emulateMedia({ colorScheme }),

  /** Whether pages are looked at on some screens only; continuous integration looks at all. */
  isBrief: () => process.env.SWEEPS === "some",

  async press(context, ...keys) {
    await focusFrame(context);
    for (const key of keys) await context.page.keyboard.press(key);
  },

  async type(context, text) {
    await focusFrame(context);
    if (!isRecording()) await context.page.keyboard.type(text);
    else for (const key of text) await context.page.keyboard.type(key);
  },

  /** Puts a text where the focus is, at once. */
  async insertText(context, text) {
    await focusFrame(context);
    await context.page.keyboard.insertText(text);
  },

  keyDown: ({ page }, key) => page.keyboard.down(key),
  keyUp: ({ page }, key) => page.keyboard.up(key),

  /** Moves the mouse there in so many steps from where it was put last. */
  async mouseMove(context, x, y, steps = 1) {
    const { page } = context;
    const to = await onPage(context, x, y);
    const from = mice.get(page) ?? to;
    mice.set(page, to);
    if (!isRecording()) return page.mouse.move(to.x, to.y, { steps });
    for (let step = 1; step <= steps; step++)
      await page.mouse.move(from.x + ((to.x - from.x) * step) / steps, from.y + ((to.y - from.y) * step) / steps);
  },
  mouseDown: ({ page }, button = "left") => page.mouse.down({ button }),
  mouseUp: ({ page }, button = "left") => page.mouse.up({ button }),
  mouseWheel: ({ page }, x, y) => page.mouse.wheel(x, y),
  async tap(context, x, y) {
    const to = await onPage(context, x, y);
    await context.page.touchscreen.tap(to.x, to.y);
  },

  /** The next file that the page gives to download. */
  async nextDownload({ page }) {
    const download = await page.waitForEvent("download");
    return { name: download.suggestedFilename(), text: readFileSync(await download.path(), "utf-8") };
  },
};

/** Starts the Ruler; it ends with this process. */
async function startedServer() {
  const folder = mkdtempSync(join(tmpdir(), "testudo-page-"));
  const python = process.env.PYTHON ?? "../.venv/bin/python";
  const options = ["-m", "smarttestudo", "ruler", folder, "--port", "0", "--no-browser"];
  const ruler = spawn(python, options, {
    stdio: ["ignore", "pipe", "inherit"],
    env: { ...process.env, PYTHONUNBUFFERED: "1" },
  });
  // Vitest waits for nothing that still runs.
  ruler.unref();
  ruler.stdout.unref();
  process.once("exit", () => {
    ruler.kill();
    rmSync(folder, { recursive: true });
  });
  for await (const line of createInterface({ input: ruler.stdout })) {
    const found = line.match(/http:\/\/\S+/);
    if (found !== null) return new URL(found[0]).origin;
  }
  throw new Error("the Ruler did not start");
}

function isRecording() {
  return process.env.PAGE_RECORDER !== undefined;
}

/** Where a point of the test's frame is: the page around it may have scrolled while it was small. */
async function onPage({ frame }, x, y) {
  const element = await (await frame()).frameElement();
  const box = await element.boundingBox();
  return { x: box.x + x, y: box.y + y };
}

/** Keys go to the test's frame, as where it is the whole page. */
async function focusFrame({ frame }) {
  await (await frame()).evaluate(() => {
    if (!document.hasFocus()) window.focus();
  });
}
