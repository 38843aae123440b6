// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A part of a page of the project's documentation. */
export type Part =
  | { kind: "heading"; level: number; text: string; anchor: string }
  | { kind: "paragraph"; text: string }
  | { kind: "list"; isNumbered: boolean; items: string[] }
  | { kind: "code"; text: string }
  | { kind: "table"; head: string[]; rows: string[][] };

/** Reads the Markdown that our own documentation uses. */
export function readMarkdown(text: string): Part[] {
  const lines = text.replace(/<!--[\s\S]*?-->/g, "").split(/\r?\n/);
  const parts: Part[] = [];
  let at = 0;
  while (at < lines.length) {
    const line = lines[at] ?? "";
    const read = line.trim() === "" ? 1 : readPart(lines.slice(at), parts);
    at += read;
  }
  return parts;
}

/** Reads the part that the first line starts; returns how many lines it has. */
function readPart(lines: readonly string[], parts: Part[]): number {
  const [first = ""] = lines;
  const heading = /^(#+) (.*)$/.exec(first);
  if (heading) {
    const title = heading[2] ?? "";
    parts.push({ kind: "heading", level: heading[1]?.length ?? 1, text: title, anchor: anchorOf(title) });
    return 1;
  }
  if (first.startsWith("```")) {
    const end = lines.findIndex((line, index) => index > 0 && line.startsWith("```"));
    parts.push({ kind: "code", text: lines.slice(1, end).join("\n") });
    return end + 1;
  }
  if (first.startsWith("|")) return readTable(lines, parts);
  if (BULLET.test(first)) return readList(lines, parts);
  const end = lengthOf(lines, (line) => line.trim() !== "" && !/^(#|```|\|)/.test(line) && !BULLET.test(line));
  parts.push({ kind: "paragraph", text: lines.slice(0, end).join(" ") });
  return end;
}

const BULLET = /^(-|\d+\.) /;

function readTable(lines: readonly string[], parts: Part[]): number {
  const end = lengthOf(lines, (line) => line.startsWith("|"));
  const cells = lines.slice(0, end).map((line) => line.slice(1, line.lastIndexOf("|")).split("|").map((cell) => cell.trim()));
  parts.push({ kind: "table", head: cells[0] ?? [], rows: cells.slice(2) });
  return end;
}

function readList(lines: readonly string[], parts: Part[]): number {
  const end = lengthOf(lines, (line) => BULLET.test(line) || /^ +\S/.test(line));
  const items: string[] = [];
  for (const line of lines.slice(0, end)) {
    if (BULLET.test(line)) items.push(line.replace(BULLET, ""));
    else items.push(`${items.pop() ?? ""} ${line.trim()}`);
  }
  parts.push({ kind: "list", isNumbered: /^\d/.test(lines[0] ?? ""), items });
  return end;
}

function lengthOf(lines: readonly string[], isInside: (line: string) => boolean): number {
  const end = lines.findIndex((line, index) => index > 0 && !isInside(line));
  return end < 0 ? lines.length : end;
}

/** The name by which other places point to a heading, as GitHub has it. */
function anchorOf(title: string): string {
  return title
    .toLowerCase()
    .replace(/[^\w\s/-]/g, "")
    .replaceAll("/", "")
    .replaceAll(/\s/g, "-");
}
