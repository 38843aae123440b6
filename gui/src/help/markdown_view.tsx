// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChild } from "preact";
import { href } from "../route";
import { type Part, readMarkdown } from "./markdown";

/** A page of the project's documentation; its first heading is left to who shows it. */
export function MarkdownView({ text }: { text: string }) {
  const parts = readMarkdown(text).filter((part) => part.kind !== "heading" || part.level > 1);
  return <>{parts.map((part, index) => partView(part, index))}</>;
}

function partView(part: Part, key: number): ComponentChild {
  switch (part.kind) {
    case "heading":
      return (
        <h3 key={key} id={part.anchor}>
          {inline(part.text)}
        </h3>
      );
    case "paragraph":
      return <p key={key}>{inline(part.text)}</p>;
    case "list": {
      const items = part.items.map((item, index) => <li key={index}>{inline(item)}</li>);
      return part.isNumbered ? <ol key={key}>{items}</ol> : <ul key={key}>{items}</ul>;
    }
    case "code":
      return (
        <pre key={key} tabIndex={0}>
          <code>{part.text}</code>
        </pre>
      );
    case "table":
      return <TableView key={key} head={part.head} rows={part.rows} />;
  }
}

function TableView({ head, rows }: { head: string[]; rows: string[][] }) {
  return (
    <div class="table-scroll">
      <table class="reference">
        <thead>
          <tr>
            {head.map((cell, index) => (
              <th key={index} scope="col">
                {inline(cell)}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row, index) => (
            <tr key={index}>
              {row.map((cell, column) => (
                <td key={column}>{inline(cell)}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

const MARKS = /`([^`]+)`|\*\*([^*]+)\*\*|\*([^*]+)\*|\[([^\]]+)\]\(([^)]+)\)/g;

/** Code, emphasis and links; a link leads to a heading on this page, any other is only read. */
function inline(text: string): ComponentChild[] {
  const found: ComponentChild[] = [];
  let end = 0;
  for (const match of text.matchAll(MARKS)) {
    found.push(text.slice(end, match.index));
    end = match.index + match[0].length;
    const [, code, strong, emphasis, label = "", target = ""] = match;
    if (code !== undefined) found.push(<code>{code}</code>);
    else if (strong !== undefined) found.push(<strong>{strong}</strong>);
    else if (emphasis !== undefined) found.push(<em>{emphasis}</em>);
    else found.push(target.startsWith("#") ? <a href={href({ page: "help", name: target.slice(1) })}>{label}</a> : label);
  }
  found.push(text.slice(end));
  return found;
}
