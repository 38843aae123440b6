// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, type Signal, signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useState } from "preact/hooks";
import { refusalOf, type TextFile } from "../api/client";
import type { EditAnswer, ImportConflict, ImportPreview, PlacedFinding, Project, Statement } from "../api/types";
import { statementTitle } from "../blocks/rule_words";
import type { RuleEditor } from "../state/rule_editor";
import { Button } from "../ui/button";
import { FormDialog } from "../ui/dialog";
import { baseName, download, fileText, useDroppedFile } from "../ui/files";
import { Problem } from "../ui/notice";

export type Sharing = "import" | "export" | null;

interface Props {
  editor: RuleEditor;
  project: Project;
  /** Which of the two is asked for. */
  sharing: Signal<Sharing>;
}

/** What asks which rules to import or to export; a file dropped on the page is imported too. */
export function ShareDialogs({ sharing, ...props }: Props) {
  const [dropped, setDropped] = useState<File | null>(null);
  const close = () => {
    sharing.value = null;
    setDropped(null);
  };
  useDroppedFile((file) => {
    setDropped(file);
    sharing.value = "import";
  });
  if (sharing.value === "import") return <ImportDialog {...props} dropped={dropped} onClose={close} />;
  if (sharing.value === "export") return <ExportDialog {...props} onClose={close} />;
  return null;
}

/** Brings rules of another file into this one; `dropped` is a file that somebody dropped on the page. */
function ImportDialog(props: { editor: RuleEditor; project: Project; dropped: File | null; onClose: () => void }) {
  const draft = useMemo(() => new ImportDraft(props.editor), []);
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

/** The statement of the same name in this file, and which of the two shall stay. */
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

/** Downloads a rule file of the statements that somebody chooses. */
function ExportDialog({ editor, onClose }: { editor: RuleEditor; onClose: () => void }) {
  const [rules] = useState(editor.rules);
  const [{ statements, broken }] = useState(() => offered(editor));
  const [chosen, setChosen] = useState<ReadonlySet<string>>(() => pointedAt(editor, broken));
  const save = async () => {
    const { text } = await editor.api.ask("POST /api/export", { text: rules.text, name: rules.name, ids: [...chosen] });
    download(baseName(rules.name).replace(/\.adirf$/, "-part.adirf"), text);
    onClose();
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

/** Statements with a checkbox each; one with a `problem` cannot be chosen. */
function StatementChecklist(props: {
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

function idOf(statement: Statement): string {
  return statement.id ?? "";
}

/** An import that is being put together: the other file, what of it shall come, and what that leads to. */
export class ImportDraft {
  readonly source = signal<TextFile | null>(null);
  readonly preview = signal<ImportPreview | null>(null);
  readonly chosen = signal<ReadonlySet<string>>(new Set());
  readonly replacing = signal<ReadonlySet<string>>(new Set());
  readonly problem = signal("");
  /** The file as it would be; null while the server thinks. */
  private readonly outcome = signal<EditAnswer | null>(null);
  readonly statements = computed(
    () => this.preview.value?.document.collections.flatMap((collection) => collection.statements) ?? [],
  );
  readonly newFindings = computed(() => {
    if (this.chosen.value.size === 0) return [];
    return this.outcome.value && added(this.before, this.outcome.value.document.findings);
  });
  private readonly rules;
  private readonly before: readonly PlacedFinding[];

  constructor(private readonly editor: RuleEditor) {
    this.rules = editor.rules;
    this.before = editor.document.peek().findings;
  }

  /** Reads another file of the project. */
  readProject(name: string): Promise<void> {
    return this.read(() => this.editor.api.read(name));
  }

  /** Reads a file of the user's disk. */
  readDisk(file: File): Promise<void> {
    return this.read(() => fileText(file));
  }

  conflict(id: string): ImportConflict | undefined {
    return this.preview.value?.conflicts.find((each) => each.id === id);
  }

  choose(chosen: ReadonlySet<string>): void {
    this.chosen.value = chosen;
    void this.work();
  }

  /** Whether a statement shall take the place of the one of the same name. */
  replace(id: string, isWanted: boolean): void {
    const next = new Set(this.replacing.value);
    if (isWanted) next.add(id);
    else next.delete(id);
    this.replacing.value = next;
    void this.work();
  }

  /** Does the import, as one step of undo; false where it could not be done. */
  async take(): Promise<boolean> {
    await this.work();
    const outcome = this.outcome.value;
    if (outcome === null) return false;
    if (this.editor.text.peek() !== this.rules.text) {
      this.problem.value = `${this.rules.name} was changed since this was opened, so nothing was imported: close it and import again`;
      return false;
    }
    const count = this.chosen.value.size;
    await this.editor.setText(outcome.text);
    this.editor.message.value = `Imported ${count} of ${this.source.value?.name ?? ""}`;
    return true;
  }

  private async read(source: () => Promise<TextFile>): Promise<void> {
    await this.try(async () => {
      const file = await source();
      const preview = await this.editor.api.ask("POST /api/import/preview", {
        text: this.rules.text,
        name: this.rules.name,
        other_text: file.text,
        other_name: file.name,
      });
      const same = new Set(preview.conflicts.filter((each) => each.is_same).map(({ id }) => id));
      const all = preview.document.collections.flatMap((collection) => collection.statements);
      batch(() => {
        this.source.value = file;
        this.preview.value = preview;
        this.replacing.value = new Set();
        this.problem.value = all.length === 0 ? `${file.name} holds no rules` : "";
      });
      const coming = all.filter((each) => each.kind !== "raw" && !same.has(each.id ?? ""));
      this.choose(new Set(coming.map((each) => each.id ?? "")));
    });
  }

  /** Asks what the file would be; an answer about a choice of the past is dropped. */
  private async work(): Promise<void> {
    const [source, chosen, replacing] = [this.source.value, this.chosen.value, this.replacing.value];
    this.outcome.value = null;
    if (source === null || chosen.size === 0) return;
    await this.try(async () => {
      const replace_ids = [...replacing].filter((id) => chosen.has(id));
      const answer = await this.editor.api.ask("POST /api/import", {
        ...this.rules,
        other_text: source.text,
        ids: [...chosen],
        replace_ids,
      });
      if (chosen === this.chosen.value && replacing === this.replacing.value) this.outcome.value = answer;
    });
  }

  private async try(work: () => Promise<void>): Promise<void> {
    const why = await refusalOf(work);
    if (why !== "") this.problem.value = why;
  }
}

/** The findings that were not there before, wherever they stand now. */
function added(before: readonly PlacedFinding[], after: readonly PlacedFinding[]): PlacedFinding[] {
  const known = new Map<string, number>();
  const word = ({ code, message }: PlacedFinding) => `${code} ${message}`;
  for (const finding of before) known.set(word(finding), (known.get(word(finding)) ?? 0) + 1);
  return after.filter((finding) => {
    const count = known.get(word(finding)) ?? 0;
    known.set(word(finding), count - 1);
    return count <= 0;
  });
}
