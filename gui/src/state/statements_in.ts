// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { RuleDocument, Statement } from "../api/types";

/** All statements of a document in the order of the text. */
export function statementsIn({ collections }: Pick<RuleDocument, "collections">): Statement[] {
  return collections.flatMap(({ statements }) => statements);
}
