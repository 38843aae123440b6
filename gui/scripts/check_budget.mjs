// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Fails the build when the page grew too heavy: the first view, and everything a browser can ever load, as it is sent.
import { existsSync, readdirSync, readFileSync, statSync } from "node:fs";

const FIRST_VIEW_LIMIT_KB = 60;
const TOTAL_LIMIT_KB = 500;
const ROOT = new URL("../../src/smarttestudo/ruler/server/static/", import.meta.url);

const sentKb = (file) => {
  const compressed = new URL(`${file}.br`, ROOT);
  return statSync(existsSync(compressed) ? compressed : new URL(file, ROOT)).size / 1000;
};
const files = readdirSync(ROOT, { recursive: true, withFileTypes: true })
  .filter((entry) => entry.isFile() && !/\.(br|gz)$/.test(entry.name))
  .map((entry) => `${entry.parentPath}/${entry.name}`.slice(ROOT.pathname.length).replace(/^\//, ""));
const page = readFileSync(new URL("index.html", ROOT), "utf8");
const first = files.filter((file) => file === "index.html" || page.includes(file));

const sum = (names) => names.reduce((total, name) => total + sentKb(name), 0);
const firstKb = sum(first);
const totalKb = sum(files);
console.log(`first view ${firstKb.toFixed(1)} KB, everything ${totalKb.toFixed(1)} KB (as sent, brotli)`);
if (firstKb > FIRST_VIEW_LIMIT_KB || totalKb > TOTAL_LIMIT_KB) {
  console.error(`The limits are ${FIRST_VIEW_LIMIT_KB} and ${TOTAL_LIMIT_KB} KB.`);
  process.exit(1);
}
