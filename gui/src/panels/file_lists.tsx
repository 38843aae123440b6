// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import type { FileAnswer, FileKind, FileLoad, FileSummary, FoundFile, LastTry, Project } from "../api/types";
import { href, type Route } from "../route";
import type { OpenEditors } from "../state/open_editors";
import { followersOf } from "../state/robot_trouble";
import { Button } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { FormDialog, typedName } from "../ui/dialog";
import { baseName, byFolder } from "../ui/files";
import { MenuButton, MenuItem } from "../ui/header";
import { useAnswer } from "../ui/later";
import { Breakable } from "../ui/notice";
import { ago, kilobytes, moment, readable } from "../ui/numbers";

type Props = FileActsProps;

/** The loads and last tries of so many rule files are asked for. */
const MOST_SUMMARIES = 200;
const ENDINGS = { rules: ".adirf", profile: ".toml" };

/** A file of the project, or one that is in this browser only. */
interface Row {
  name: string;
  file: FoundFile | null;
}

/** The files of the project by folder, those that were changed last first, with what can be done with them. */
export function FileLists({ onNew, ...props }: Props & { onNew: () => void }) {
  const [wanted, setWanted] = useState("");
  const hasRules = props.project.files.some(({ kind }) => kind === "rules");
  const { answer } = useAnswer(() => props.api.ask("GET /api/drafts", null), [props.project]);
  const asked = { wanted, drafts: answer?.drafts.map(({ name }) => name) ?? [], summaries: useSummaries(props) };
  return (
    <>
      {!hasRules && <p class="lead">Say how often each topic of your robot is worth sending, and when.</p>}
      <div class="row file-bar">
        <input
          type="search"
          class="file-search"
          aria-label="Find a file"
          placeholder="Find a file"
          value={wanted}
          onInput={(event) => setWanted(event.currentTarget.value)}
        />
        <NeedsServer changes>
          <Button label="New Rule File" class={hasRules ? "" : "primary"} onClick={onNew} />
        </NeedsServer>
      </div>
      <FileList {...props} {...asked} kind="rules" title="Rules" page="rules" />
      <FileList {...props} {...asked} kind="profile" title="Topic parameters" page="topics" />
    </>
  );
}

/** What the server says of each rule file, one after the other; what it said before stays meanwhile. */
function useSummaries({ api, project }: Props): ReadonlyMap<string, FileSummary> {
  const [known, setKnown] = useState<ReadonlyMap<string, FileSummary>>(new Map());
  useEffect(() => {
    let isLeft = false;
    const look = async () => {
      for (const { name } of savedFiles(project, "rules").slice(0, MOST_SUMMARIES)) {
        const one = await api.ask("GET /api/file/summary", null, { name });
        if (isLeft) return;
        setKnown((before) => new Map(before).set(name, one));
      }
    };
    // A list without them is still a list.
    void refusalOf(look);
    return () => {
      isLeft = true;
    };
  }, [project]);
  return known;
}

interface ListProps extends Props {
  summaries: ReadonlyMap<string, FileSummary>;
  drafts: readonly string[];
  wanted: string;
  kind: Extract<FileKind, "rules" | "profile">;
  title: string;
  page: Route["page"];
}

function FileList({ wanted, kind, title, drafts, ...props }: ListProps) {
  const { project, editors } = props;
  const unsaved = new Set([...editors.unsaved(), ...drafts].filter((name) => name.endsWith(ENDINGS[kind])));
  const all = rowsOf(project, kind, unsaved);
  const words = wanted.toLowerCase().split(/\s+/);
  const rows = all.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
  const list = (some: readonly Row[]) => <FileRows {...props} {...{ kind, unsaved }} rows={some} />;
  const count = rows.length === all.length ? all.length : `${rows.length} of ${all.length}`;
  return (
    <section aria-label={title}>
      <h2>
        {title} {all.length > 0 && <span class="quiet">{count}</span>}
      </h2>
      {rows.length === 0 && (
        <p class="quiet">
          {all.length === 0
            ? `No ${kind === "rules" ? "rule file" : "file of topic parameters"} in ${project.root_name} yet.`
            : `None with “${wanted}”.`}
        </p>
      )}
      <div class="file-list">
        {[...byFolder(rows)].map(([folder, some]) =>
          folder === "" ? (
            list(some)
          ) : (
            <details key={folder} open>
              <summary>
                {folder} <span class="quiet">{some.length}</span>
              </summary>
              {list(some)}
            </details>
          ),
        )}
      </div>
    </section>
  );
}

/** The files of one kind, those that were changed last first. */
function savedFiles({ files }: Project, kind: FileKind): FoundFile[] {
  return files.filter((file) => file.kind === kind).sort((a, b) => b.changed_at_s - a.changed_at_s);
}

function rowsOf(project: Project, kind: FileKind, unsaved: ReadonlySet<string>): Row[] {
  const saved = savedFiles(project, kind);
  const isThere = new Set(saved.map(({ name }) => name));
  return [
    ...[...unsaved].filter((name) => !isThere.has(name)).map((name) => ({ name, file: null })),
    ...saved.map((file) => ({ name: file.name, file })),
  ];
}

interface RowsProps extends Omit<ListProps, "wanted" | "title" | "drafts"> {
  rows: readonly Row[];
  unsaved: ReadonlySet<string>;
}

function FileRows({ rows, unsaved, kind, page, summaries, ...props }: RowsProps) {
  return (
    <ul class="files">
      {rows.map(({ name, file }) => (
        <li key={name}>
          <a class="file-name" href={href({ page, name })} aria-label={name}>
            <Breakable name={baseName(name)} />
          </a>
          <span class="file-notes quiet">
            {unsaved.has(name) && <span class="drafted">draft, not saved</span>}
            {kind === "rules" && <Followers name={name} />}
            <Load load={summaries.get(name)?.load} />
            <LastTryWords last={summaries.get(name)?.last_try} />
            {file && <time title={moment(1000 * file.changed_at_s)}>{ago(1000 * file.changed_at_s, Date.now())}</time>}
          </span>
          <FileActs {...props} {...{ name }} isSaved={file !== null && !unsaved.has(name)} />
        </li>
      ))}
    </ul>
  );
}

/** What the rules take of the budget where they take most. */
function Load({ load }: { load: FileLoad | null | undefined }) {
  if (!load) return null;
  const { kb_per_s, budget_kb_per_s } = load;
  return (
    <span class={kb_per_s > budget_kb_per_s ? "over" : ""} title="Where the rules take most of the budget">
      worst case {kilobytes(kb_per_s)} of {kilobytes(budget_kb_per_s)} KB/s
    </span>
  );
}

/** What the last try said of the rules, and when. */
function LastTryWords({ last }: { last: LastTry | null | undefined }) {
  if (!last) return null;
  const { bag, kb_per_s, percent, tried_at_ms } = last;
  return (
    <span title={`Tried on ${bag === "/" ? "all recordings" : bag}, ${moment(tried_at_ms)}`}>
      tried {ago(tried_at_ms, Date.now())} on {bag === "/" ? "all" : baseName(bag.replace(/\/$/, ""))}:{" "}
      {`${readable(kb_per_s)} KB/s, ${readable(percent)}\u00a0% less`}
    </span>
  );
}

/** The robots that follow a file of this name. */
function Followers({ name }: { name: string }) {
  const robots = followersOf(name, useRobot().robots.value?.robots ?? []);
  return (
    <>
      {robots.map(({ node, label }) => (
        <a key={node} class="follower" href={href({ page: "rules", name, robot: node })}>
          on {label}
        </a>
      ))}
    </>
  );
}

interface FileActsProps {
  api: Api;
  editors: OpenEditors;
  project: Project;
  refresh: () => Promise<void>;
  /** What was deleted, so that it can be brought back. */
  onDeleted: (file: FileAnswer) => void;
  onRefused: (why: string) => void;
}

type Asked = "rename" | "duplicate" | null;

/** What can be done with a file besides opening it. */
function FileActs(props: FileActsProps & { name: string; isSaved: boolean }) {
  const { api, editors, name, isSaved, refresh, onDeleted, onRefused } = props;
  const [asked, setAsked] = useState<Asked>(null);
  const guarded = async (work: () => Promise<void>) => {
    const why = await refusalOf(work);
    if (why !== "") onRefused(why);
    await refresh();
  };
  const remove = async () => {
    const file = await api.read(name);
    await api.ask("POST /api/file/delete", { name, base_hash: file.hash });
    onDeleted(file);
  };
  return (
    <>
      <MenuButton label={`More for ${name}`} icon="more">
        <NeedsServer changes>
          <MenuItem label="Rename" isDisabled={!isSaved} act={() => setAsked("rename")} />
          <MenuItem label="Duplicate" isDisabled={!isSaved} act={() => setAsked("duplicate")} />
          <MenuItem label="Delete" isDisabled={!isSaved} act={() => void guarded(remove)} />
          {!isSaved && <MenuItem label="Discard the draft" act={() => void guarded(() => editors.discard(name))} />}
        </NeedsServer>
      </MenuButton>
      {asked !== null && <NameDialog {...props} isCopy={asked === "duplicate"} onClose={() => setAsked(null)} />}
    </>
  );
}

/** Asks for a name, for a copy or for the file itself. */
function NameDialog(props: FileActsProps & { name: string; isCopy: boolean; onClose: () => void }) {
  const { api, name, isCopy, project, refresh, onClose } = props;
  const followers = followersOf(name, useRobot().robots.value?.robots ?? []);
  const ending = name.slice(name.lastIndexOf("."));
  const call = async (form: FormData) => {
    const asked = { name, new_name: typedName(form, ending) };
    try {
      if (isCopy) await api.ask("POST /api/file/copy", asked);
      else if (asked.new_name !== name) {
        const { hash } = await api.read(name);
        await api.ask("POST /api/file/rename", { ...asked, base_hash: hash });
      }
      onClose();
    } finally {
      await refresh();
    }
  };
  return (
    <FormDialog
      title={isCopy ? `Duplicate ${name}` : `Rename ${name}`}
      submit={isCopy ? "Duplicate" : "Rename"}
      onSubmit={call}
      onClose={onClose}
    >
      <label>
        Name
        <input
          name="name"
          required
          autofocus
          autocomplete="off"
          defaultValue={isCopy ? copyName(name, project) : name}
        />
      </label>
      <p class="quiet">A / in the name puts the file into a folder of {project.root_name}.</p>
      {!isCopy && followers.length > 0 && (
        <p>
          {followers.map(({ label }) => label).join(", ")} {followers.length === 1 ? "follows" : "follow"} a file of
          this name, and will not find it under another one.
        </p>
      )}
    </FormDialog>
  );
}

/** The first free of `a_copy.adirf`, `a_copy_2.adirf`, … */
function copyName(name: string, { files }: Project): string {
  const dot = name.lastIndexOf(".");
  const named = (count: number) => `${name.slice(0, dot)}_copy${count === 1 ? "" : `_${count}`}${name.slice(dot)}`;
  const taken = new Set(files.map((file) => file.name));
  let count = 1;
  while (taken.has(named(count))) count++;
  return named(count);
}
