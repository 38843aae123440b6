// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { ApiError } from "./client";

/** What the server says when it refuses; anything else is a bug and goes on. */
export function refusal(error: unknown): string {
  if (!(error instanceof ApiError)) throw error;
  return error.message;
}

/** Does work; what the server refused of it, empty where it is done. */
export async function refusalOf(work: () => Promise<unknown>): Promise<string> {
  try {
    await work();
    return "";
  } catch (error) {
    return refusal(error);
  }
}
