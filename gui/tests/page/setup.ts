// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect } from "vitest";
import { locators } from "vitest/browser";
import main from "../../src/main.tsx?raw";
import { closePage, resize } from "./ruler_page";

const SHEETS = import.meta.glob("../../src/style/*.css");
const SCREEN = { width: 1440, height: 900 };

// The sheets of the page in its order.
for (const [, name] of main.matchAll(/^import "\.\/style\/(.*)";$/gm)) await SHEETS[`../../src/style/${name}`]?.();

locators.extend({ getByCss: (selector: string) => selector });

beforeEach(async () => {
  localStorage.clear();
  sessionStorage.clear();
  for (const { name } of await indexedDB.databases()) if (name !== undefined) indexedDB.deleteDatabase(name);
  await resize(SCREEN.width, SCREEN.height);
});

afterEach(async ({ task }) => {
  const complaints = await closePage();
  history.replaceState(null, "", location.pathname + location.search);
  if (task.result?.state !== "fail" || complaints.some((each) => each.includes("make page-answers")))
    expect(complaints).toEqual([]);
});
