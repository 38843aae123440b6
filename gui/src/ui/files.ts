// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { Refused, type TextFile } from "../api/client";
import { useWindowEvent } from "./watch";

const LARGEST_BYTES = 1_000_000;

/** Reads a file of the user's disk; refuses one that is no text or too large for a rule file. */
export async function fileText(file: File): Promise<TextFile> {
  if (file.size > LARGEST_BYTES) throw new Refused(`${file.name} is larger than 1 MB: it is not a rule file`);
  try {
    const text = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(await file.arrayBuffer());
    return { name: file.name, text };
  } catch {
    throw new Refused(`${file.name} is not UTF-8 text: it is not a rule file`);
  }
}

/** What a file is called, without its folders. */
export function baseName(path: string): string {
  return path.slice(path.lastIndexOf("/") + 1);
}

/** The folder of a file, with its `/`; empty for a file in the project's own. */
export function folderOf(path: string): string {
  return path.slice(0, path.lastIndexOf("/") + 1);
}

/** The rows of each folder, those of the project's own first; folders in the order of their first row. */
export function byFolder<T extends { name: string }>(rows: readonly T[]): ReadonlyMap<string, T[]> {
  const folders = new Map<string, T[]>();
  const own = rows.filter(({ name }) => folderOf(name) === "");
  if (own.length > 0) folders.set("", own);
  for (const row of rows) {
    const folder = folderOf(row.name);
    if (folder !== "") folders.set(folder, [...(folders.get(folder) ?? []), row]);
  }
  return folders;
}

/** Takes a file that is dropped anywhere on the page; without this the browser would leave the page for it. */
export function useDroppedFile(take: (file: File) => void): void {
  const over = (event: DragEvent) => {
    if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
  };
  const drop = (event: DragEvent) => {
    const file = event.dataTransfer?.files[0];
    if (!file) return;
    event.preventDefault();
    event.stopPropagation();
    take(file);
  };
  useWindowEvent("dragover", over, { capture: true });
  useWindowEvent("drop", drop, { capture: true });
}

/** Hands a text to the browser as a file. */
export function download(name: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
