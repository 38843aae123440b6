// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { TextFile } from "../api/client";

const LARGEST_BYTES = 1_000_000;

/** A file that cannot be used, with the reason. */
export class FileProblem extends Error {}

/** Reads a file of the user's disk; FileProblem for one that is no text or too large for a rule file. */
export async function fileText(file: File): Promise<TextFile> {
  if (file.size > LARGEST_BYTES) throw new FileProblem(`${file.name} is larger than 1 MB: it is not a rule file`);
  try {
    const text = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(await file.arrayBuffer());
    return { name: file.name, text };
  } catch {
    throw new FileProblem(`${file.name} is not UTF-8 text: it is not a rule file`);
  }
}
