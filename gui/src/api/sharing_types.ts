// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// What the server says about rules that come and go; src/smarttestudo/web/sharing_schemas.py has the meaning.
import type { RuleDocument } from "./types";

/** A text and what its file is called. */
export interface TextFile {
  name: string;
  text: string;
}
export interface Encounter {
  id: string;
  is_same: boolean;
  message: string;
}
export interface ImportPreview {
  document: RuleDocument;
  encounters: Encounter[];
}
export interface ImportChoice {
  ids: string[];
  replace_ids: string[];
}
