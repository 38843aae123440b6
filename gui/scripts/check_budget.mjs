// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Fails the build when the page grew too heavy: the first view, and everything a browser can ever load.
import { readdirSync, readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";

const FIRST_VIEW_LIMIT_KB = 150;
const TOTAL_LIMIT_KB = 600;
const ROOT = new URL("../../src/smarttestudo/web/static/", import.meta.url);

const gzipKb = (file) => gzipSync(readFileSync(new URL(file, ROOT))).length / 1000;
const files = readdirSync(ROOT, { recursive: true, withFileTypes: true })
  .filter((entry) => entry.isFile())
  .map((entry) => `${entry.parentPath}/${entry.name}`.slice(ROOT.pathname.length).replace(/^\//, ""));
const page = readFileSync(new URL("index.html", ROOT), "utf8");
const first = files.filter((file) => file === "index.html" || page.includes(file));

const sum = (names) => names.reduce((total, name) => total + gzipKb(name), 0);
const firstKb = sum(first);
const totalKb = sum(files);
console.log(`first view ${firstKb.toFixed(1)} KB, everything ${totalKb.toFixed(1)} KB (gzip)`);
if (firstKb > FIRST_VIEW_LIMIT_KB || totalKb > TOTAL_LIMIT_KB) {
  console.error(`The limits are ${FIRST_VIEW_LIMIT_KB} and ${TOTAL_LIMIT_KB} KB.`);
  process.exit(1);
}
