// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A stretch of the text that one side points at and the other shows. */
export interface Spot {
  offset: number;
  end_offset: number;
  from: "text" | "blocks" | "findings" | "map" | "try";
}
