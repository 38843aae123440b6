// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Statement } from "../api/types";
import { rateText } from "../blocks/rate_text";

/** A statement in a few words, for lists. */
export function statementTitle(statement: Statement): string {
  switch (statement.kind) {
    case "set": {
      const unit = statement.rate.kind === "hz" ? " Hz" : "";
      return `${statement.topic} at ${rateText(statement.rate)}${unit}`;
    }
    case "keep":
      return `keep ${statement.topic} at least at ${statement.hz} Hz`;
    case "within":
      return `keep ${statement.topic} ${statement.property} within ${statement.bound}`;
    case "rule":
      return `Rule ${statement.name ?? statement.label ?? `in line ${statement.line ?? ""}`}`;
    case "raw":
      return statement.text.split(/\r?\n/, 1)[0] ?? "";
  }
}
