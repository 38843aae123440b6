// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Edit, PlacedCollection, Statement } from "../api/types";

/** The statements after an edit by the blocks, numbered as the server will number them. */
export function edited(collections: PlacedCollection[], edit: Edit): PlacedCollection[] {
  const lists = new Map(collections.map(({ id, statements }) => [id, [...statements]]));
  switch (edit.kind) {
    case "delete":
      takeOut(lists, edit.id);
      break;
    case "replace":
      replace(lists, edit.id, edit.statement);
      break;
    case "insert":
      lists.get(edit.collection)?.splice(edit.index, 0, edit.statement);
      break;
    case "move": {
      const statement = takeOut(lists, edit.id);
      if (statement) lists.get(edit.collection)?.splice(edit.index, 0, statement);
    }
  }
  let number = 0;
  return collections.map((collection) => ({
    ...collection,
    statements: (lists.get(collection.id) ?? []).map((statement) => ({ ...statement, id: `s${++number}` })),
  }));
}

type Lists = ReadonlyMap<string, Statement[]>;

function takeOut(lists: Lists, id: string): Statement | undefined {
  for (const statements of lists.values()) {
    const index = statements.findIndex((each) => each.id === id);
    if (index >= 0) return statements.splice(index, 1)[0];
  }
  return undefined;
}

function replace(lists: Lists, id: string, statement: Statement): void {
  for (const statements of lists.values()) {
    const index = statements.findIndex((each) => each.id === id);
    const old = statements[index];
    if (old) statements[index] = { ...statement, comments: statement.comments ?? old.comments ?? null };
  }
}
