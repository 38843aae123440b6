// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import type { Statement } from "../api/types";
import { statementTitle } from "../blocks/rule_words";
import { Button } from "../ui/button";

/** Statements with a checkbox each; one with a `problem` cannot be chosen. */
export function StatementChecklist(props: {
  label: string;
  statements: readonly Statement[];
  chosen: ReadonlySet<string>;
  onChoose: (chosen: ReadonlySet<string>) => void;
  problem: (statement: Statement) => string | null;
  note?: (statement: Statement) => ComponentChildren;
}) {
  const free = props.statements.filter((each) => props.problem(each) === null).map(idOf);
  const turn = (id: string) => {
    const next = new Set(props.chosen);
    if (!next.delete(id)) next.add(id);
    props.onChoose(next);
  };
  return (
    <fieldset class="checklist">
      <legend class="visually-hidden">{props.label}</legend>
      <div class="row">
        <span class="quiet" role="status">
          {props.chosen.size} of {props.statements.length} chosen
        </span>
        <Button label="All" class="small" onClick={() => props.onChoose(new Set(free))} />
        <Button label="None" class="small" onClick={() => props.onChoose(new Set())} />
      </div>
      <ul>
        {props.statements.map((statement) => {
          const [id, problem] = [idOf(statement), props.problem(statement)];
          return (
            <li key={id}>
              <label>
                <input
                  type="checkbox"
                  checked={props.chosen.has(id)}
                  disabled={problem !== null}
                  onChange={() => turn(id)}
                />
                <span>{statementTitle(statement)}</span>
                <span class="quiet">line {statement.line}</span>
              </label>
              {problem !== null && <span class="problem">{problem}</span>}
              {props.note?.(statement)}
            </li>
          );
        })}
      </ul>
    </fieldset>
  );
}

export function idOf(statement: Statement): string {
  return statement.id ?? "";
}
