// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo } from "preact/hooks";
import type { Api, TextFile } from "../api/client";
import type { Project, Statement } from "../api/types";
import { ImportDraft } from "../state/import_draft";
import type { RuleEditor } from "../state/rule_editor";
import { FormDialog } from "../ui/dialog";
import { Problem } from "../ui/notice";
import { idOf, StatementChecklist } from "./statement_checklist";

/** Brings rules of another file into this one; `dropped` is a file that somebody dropped on the page. */
export function ImportDialog(props: {
  editor: RuleEditor;
  api: Api;
  project: Project;
  dropped: File | null;
  onClose: () => void;
}) {
  const draft = useMemo(() => new ImportDraft(props.api, props.editor), []);
  useEffect(() => {
    if (props.dropped) void draft.readDisk(props.dropped);
  }, [props.dropped]);
  const take = async () => {
    if (await draft.take()) props.onClose();
  };
  const preview = draft.preview.value;
  return (
    <FormDialog
      title="Import rules"
      submit="Import"
      isWide
      canSubmit={draft.chosen.value.size > 0}
      onSubmit={take}
      onClose={props.onClose}
    >
      <SourceChoice {...props} draft={draft} />
      <Problem text={draft.problem.value} />
      {preview && (
        <StatementChecklist
          label="Parts to import"
          statements={draft.statements.value}
          chosen={draft.chosen.value}
          onChoose={(chosen) => draft.choose(chosen)}
          problem={(statement) => (statement.kind === "raw" ? "has an error and stays there" : null)}
          note={(statement) => <SharedBorder {...{ draft, statement }} />}
        />
      )}
      {preview && <NewFindings draft={draft} />}
    </FormDialog>
  );
}

function SourceChoice({ project, editor, draft }: { project: Project; editor: RuleEditor; draft: ImportDraft }) {
  const others = project.files.filter((file) => file.kind === "rules" && file.name !== editor.name);
  const source: TextFile | null = draft.source.value;
  const isOfProject = others.some((file) => file.name === source?.name);
  return (
    <div class="row">
      <label>
        From this project
        <select
          value={isOfProject ? source?.name : ""}
          onChange={(event) => void draft.readProject(event.currentTarget.value)}
        >
          <option value="" disabled>
            Choose a rule file
          </option>
          {others.map((file) => (
            <option key={file.name} value={file.name}>
              {file.name}
            </option>
          ))}
        </select>
      </label>
      <label>
        Or from this computer
        <input
          type="file"
          accept=".adirf,text/plain"
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (file) void draft.readDisk(file);
          }}
        />
      </label>
      {source && !isOfProject && <p class="quiet">{source.name}</p>}
    </div>
  );
}

/** Whom a statement meets in this file, and which of the two shall stay. */
function SharedBorder({ draft, statement }: { draft: ImportDraft; statement: Statement }) {
  const id = idOf(statement);
  const met = draft.conflict(id);
  if (met === undefined) return null;
  return (
    <span class="meeting">
      <span class="quiet">{met.message}</span>
      {!met.is_same && draft.chosen.value.has(id) && (
        <label>
          <input
            type="checkbox"
            checked={draft.replacing.value.has(id)}
            onChange={(event) => draft.replace(id, event.currentTarget.checked)}
          />
          replace it
        </label>
      )}
    </span>
  );
}

function NewFindings({ draft }: { draft: ImportDraft }) {
  const findings = draft.newFindings.value;
  if (findings === null) return <p class="quiet">Checking …</p>;
  return (
    <div role="status">
      {findings.length === 0 ? (
        <p class="quiet">The import adds no findings.</p>
      ) : (
        <>
          <p>The import adds these findings:</p>
          <ul class="findings" aria-label="Findings of the import">
            {findings.map((finding) => (
              <li key={`${finding.offset} ${finding.code} ${finding.message}`} class={finding.severity}>
                <span class="message">{finding.message}</span>
              </li>
            ))}
          </ul>
        </>
      )}
    </div>
  );
}
