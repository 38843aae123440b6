// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { TIERS } from "../api/types";
import { readable } from "../ui/numbers";
import type { LevelKind, moved } from "./level_axis";

/** Why a moved level did not go on; empty where it did. */
export function stopped(kind: LevelKind, index: number, { levels, stoppedBy }: ReturnType<typeof moved>): string {
  if (stoppedBy === null) return "";
  const way = stoppedBy < index === kind.falls ? "above" : "below";
  const at = `${readable(levels[stoppedBy] ?? 0)} ${kind.unit}`;
  return `${TIERS[index]} stops at ${TIERS[stoppedBy]} (${at}): it cannot lie ${way} it.`;
}
