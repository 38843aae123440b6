// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { CHAPTERS } from "./chapters.ts";
import { markdownHtml } from "./markdown_html.ts";

const NAME = "virtual:documentation";
const PROJECT = new URL("../../", import.meta.url);

/** Turns the project's Markdown into HTML while the page is built, so that no browser has to read Markdown. */
export function documentation() {
  return {
    name: "documentation",
    resolveId: (id) => (id === NAME ? `\0${NAME}` : undefined),
    load(id) {
      if (id !== `\0${NAME}`) return undefined;
      const chapters = CHAPTERS.map(({ file, anchor, title }) => {
        const path = fileURLToPath(new URL(file, PROJECT));
        this.addWatchFile(path);
        return { anchor, title, html: markdownHtml(readFileSync(path, "utf8"), file) };
      });
      return `export const CHAPTERS = ${JSON.stringify(chapters)};`;
    },
  };
}
