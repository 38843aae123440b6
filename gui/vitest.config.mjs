// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { accessSync, constants } from "node:fs";
import { delimiter, join } from "node:path";
import { playwright } from "@vitest/browser-playwright";
import { defineConfig, mergeConfig } from "vitest/config";
import { commands, RECORDING_STEP_MS } from "./tests/page/commands.mjs";
import vite from "./vite.config.mjs";

const CHROMIUM = ["chromium", "chromium-browser", "google-chrome"];
/** A machine with two busy cores is slow. */
const PATIENCE_MS = 60_000;
const SCREEN = { width: 1440, height: 900 };

/** The Chromium that is installed: none is downloaded. */
function chromium() {
  const folders = (process.env.PATH ?? "").split(delimiter);
  return CHROMIUM.flatMap((name) => folders.map((folder) => join(folder, name))).find(isExecutable);
}

function isExecutable(path) {
  try {
    accessSync(path, constants.X_OK);
    return true;
  } catch {
    return false;
  }
}

const executablePath = chromium();
const isRecording = process.env.PAGE_RECORDER !== undefined;
if (executablePath === undefined) {
  const missing = "Not tested: the page's components need Chromium (on Debian: sudo apt install chromium)";
  if (process.env.CI === "true" || isRecording) throw new Error(missing);
  // Each project reads this file again.
  if (process.env.TOLD_OF_CHROMIUM === undefined) console.log(missing);
  process.env.TOLD_OF_CHROMIUM = "yes";
}

const modules = {
  extends: true,
  // A process for each file takes three times as long as all tests.
  test: {
    name: "modules",
    include: ["tests/**/*.test.ts"],
    exclude: ["tests/page/**"],
    setupFiles: ["tests/timers.ts"],
    isolate: false,
  },
};
const page = {
  extends: true,
  // What is found while tests run reloads their page.
  optimizeDeps: { entries: ["src/**/*.{ts,tsx}", "tests/page/**/*.{ts,tsx}"] },
  test: {
    name: "page",
    include: ["tests/page/**/*.test.tsx"],
    setupFiles: ["tests/page/setup.ts"],
    testTimeout: (isRecording ? 10 : 2) * PATIENCE_MS,
    hookTimeout: PATIENCE_MS,
    expect: { poll: { timeout: PATIENCE_MS, interval: 20 } },
    // Files beside each other in one Chromium take the keys from each other, and other tests run beside these anyway.
    fileParallelism: false,
    browser: {
      enabled: true,
      headless: true,
      ui: false,
      screenshotFailures: false,
      viewport: SCREEN,
      commands,
      provider: playwright({
        launchOptions: { executablePath, args: ["--no-sandbox"], slowMo: isRecording ? RECORDING_STEP_MS : 0 },
        contextOptions: { viewport: SCREEN, reducedMotion: "reduce", timezoneId: "UTC", acceptDownloads: true },
        actionTimeout: PATIENCE_MS,
      }),
      instances: [{ browser: "chromium" }],
    },
  },
};

// In a fresh clone what the page needs is bundled first, beside all other tests. Vitest reads this here only.
const browser = { connectTimeout: 10 * PATIENCE_MS };

export default mergeConfig(
  vite,
  defineConfig({ test: { browser, projects: executablePath === undefined ? [modules] : [modules, page] } }),
);
