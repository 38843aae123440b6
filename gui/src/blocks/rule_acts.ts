// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Edit } from "../api/types";
import type { RuleAct } from "./block_types";
import type { Placed } from "./slots";

/** An edit of the text, and the number of the statement that it is about once it is done. */
export interface ActedOn {
  edit: Edit;
  at: number;
}

/** What an act on the rule that is number `at` does to the text; null where there is nothing to do. */
export function actedOn(all: readonly Placed[], at: number, act: RuleAct): ActedOn | null {
  const place = all[at];
  if (place?.statement.kind !== "rule") return null;
  const { statement, collection, index } = place;
  const id = statement.id ?? "";
  switch (act) {
    case "switch": {
      const is_disabled = !statement.is_disabled;
      return { edit: { kind: "replace", id, statement: { ...statement, is_disabled, comments: null } }, at };
    }
    case "duplicate":
      return { edit: { kind: "duplicate", id }, at: at + 1 };
    case "up":
    case "down": {
      const to = index + (act === "up" ? -1 : 1);
      if (to < 0 || to >= collection.statements.length) return null;
      return { edit: { kind: "move", id, collection: collection.id, index: to }, at: at + to - index };
    }
  }
}
