// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Api, ApiError } from "../api/client";

/** A text that was not saved, since somebody else changed the file; `theirs` and `hash` are null where it is gone. */
export interface Conflict {
  mine: string;
  theirs: string | null;
  hash: string | null;
}

interface OnDisk {
  text: string;
  hash: string;
}

export type DiskChange = "changed" | "gone";

/** Saves a text where the file still has this hash; else nothing is written, and what is on disk is told. */
export async function saveOver(
  api: Api,
  name: string,
  text: string,
  baseHash: string | null,
  byItself = false,
): Promise<{ hash: string; note?: string } | Conflict> {
  try {
    return await api.save(name, text, baseHash, byItself);
  } catch (error) {
    if (!isStatus(error, 409)) throw error;
  }
  const onDisk = await readIfThere(api, name);
  // The same text, as after a save whose answer got lost, is saved.
  return onDisk?.text === text ? onDisk : conflictWith(text, onDisk);
}

/** What happened to a file that had this hash. */
export async function diskChangeOf(api: Api, name: string, hash: string | null): Promise<DiskChange | null> {
  const now = (await api.fileState(name)).hash;
  if (hash === now) return null;
  return now === null ? "gone" : "changed";
}

/** An own text beside what is on disk. */
export function conflictWith(mine: string, onDisk: OnDisk | null): Conflict {
  return { mine, theirs: onDisk?.text ?? null, hash: onDisk?.hash ?? null };
}

/** Whether the server answered with this status. */
export function isStatus(error: unknown, status: number): boolean {
  return error instanceof ApiError && error.status === status;
}

/** What is on disk under a name; null where nothing is. */
export async function readIfThere(api: Api, name: string): Promise<OnDisk | null> {
  try {
    return await api.read(name);
  } catch (error) {
    if (!isStatus(error, 404)) throw error;
    return null;
  }
}
