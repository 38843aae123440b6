// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { FileKind, FoundFile, Project } from "../api/types";
import { href, type Route } from "../route";
import type { OpenEditors } from "../state/open_editors";
import { followersOf } from "../state/robot_trouble";
import { useRobot } from "../ui/robot_state";
import { ago, moment } from "../ui/times";

interface Props {
  project: Project;
  editors: OpenEditors;
}

/** The files of the project, those that were changed last first, with what is not saved of them and who follows them. */
export function FileLists({ project, editors }: Props) {
  return (
    <div class="file-lists">
      <FileList {...{ project, editors }} kind="rules" title="Rules" page="rules" />
      <FileList {...{ project, editors }} kind="profile" title="Topic parameters" page="topics" />
    </div>
  );
}

interface ListProps extends Props {
  kind: Extract<FileKind, "rules" | "profile">;
  title: string;
  page: Route["page"];
}

function FileList({ project, editors, kind, title, page }: ListProps) {
  const saved = project.files.filter((file) => file.kind === kind).sort((a, b) => b.changed_at_s - a.changed_at_s);
  const unsaved = new Set(editors.unsaved(kind));
  const isThere = new Set(saved.map(({ name }) => name));
  const rows = [
    ...[...unsaved].filter((name) => !isThere.has(name)).map((name) => ({ name, file: null })),
    ...saved.map((file) => ({ name: file.name, file })),
  ];
  return (
    <section aria-label={title}>
      <h2>{title}</h2>
      {rows.length === 0 && <p class="quiet">None in {project.root_name} yet.</p>}
      <ul class="files">
        {rows.map(({ name, file }) => (
          <li key={name}>
            <a href={href({ page, name })}>{name}</a>
            <span class="file-notes quiet">
              {kind === "rules" && <Followers name={name} />}
              {unsaved.has(name) && <span>not saved</span>}
              {file && <ChangedAt file={file} />}
            </span>
          </li>
        ))}
      </ul>
    </section>
  );
}

function ChangedAt({ file }: { file: FoundFile }) {
  const ms = file.changed_at_s * 1000;
  return <time title={moment(ms)}>{ago(ms, Date.now())}</time>;
}

/** The robots that follow a file of this name. */
function Followers({ name }: { name: string }) {
  const robots = followersOf(name, useRobot().robots.value?.robots ?? []);
  return (
    <>
      {robots.map(({ node, label }) => (
        <a key={node} class="follower" href={href({ page: "rules", name, robot: node })}>
          followed by {label}
        </a>
      ))}
    </>
  );
}
