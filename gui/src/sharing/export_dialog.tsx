// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import type { PlacedFinding, Statement } from "../api/types";
import type { RuleEditor } from "../state/rule_editor";
import { FormDialog } from "../ui/dialog";
import { download } from "../ui/files";
import { Problem } from "../ui/notice";
import { idOf, StatementChecklist } from "./statement_checklist";

/** Downloads a rule file of the statements that somebody chooses. */
export function ExportDialog({ editor, api, onClose }: { editor: RuleEditor; api: Api; onClose: () => void }) {
  const [rules] = useState(editor.rules);
  const [{ statements, broken }] = useState(() => offered(editor));
  const [chosen, setChosen] = useState<ReadonlySet<string>>(() => pointedAt(editor, broken));
  const [problem, setProblem] = useState("");
  const save = async () => {
    setProblem(
      await refusalOf(async () => {
        const { text } = await api.ask("POST /api/export", { text: rules.text, name: rules.name, ids: [...chosen] });
        download(fileName(rules.name), text);
        onClose();
      }),
    );
  };
  return (
    <FormDialog
      title="Export rules"
      submit="Export selected rules"
      isWide
      canSubmit={chosen.size > 0}
      onSubmit={save}
      onClose={onClose}
    >
      <p class="quiet">A rule file of the chosen parts, with their comments. Rules with errors stay here.</p>
      <StatementChecklist
        label="Parts to export"
        statements={statements}
        chosen={chosen}
        onChoose={setChosen}
        problem={(statement) => broken.get(idOf(statement)) ?? null}
      />
      <Problem text={problem} />
    </FormDialog>
  );
}

function offered(editor: RuleEditor): { statements: Statement[]; broken: ReadonlyMap<string, string> } {
  const { collections, findings } = editor.document.peek();
  const errors = findings.filter((finding) => stopsExport(finding) && finding.statement !== null);
  return {
    statements: collections.flatMap((collection) => collection.statements),
    broken: new Map(errors.map((finding) => [finding.statement ?? "", finding.message])),
  };
}

/** A level without a rate is no error of an exported source: its topic parameters are elsewhere. */
function stopsExport(finding: PlacedFinding): boolean {
  return finding.severity === "error" && finding.code !== "tier-without-rate";
}

/** What the cursor or the selected block stands on. */
function pointedAt(editor: RuleEditor, broken: ReadonlyMap<string, string>): ReadonlySet<string> {
  const spot = editor.spot.peek();
  const statement = spot && editor.statementAt(spot.offset);
  return new Set(statement?.id && !broken.has(statement.id) ? [statement.id] : []);
}

function fileName(name: string): string {
  return (name.split("/").at(-1) ?? "rules.adirf").replace(/\.adirf$/, "-part.adirf");
}
