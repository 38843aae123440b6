// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useState } from "preact/hooks";
import { type Api, refusal, refusalOf } from "../api/client";
import type { FileAnswer, Project } from "../api/types";
import { followersOf } from "../state/robot_trouble";
import { Button } from "../ui/button";
import { FormDialog } from "../ui/dialog";
import { Problem } from "../ui/notice";
import { useRobot } from "../ui/robot_state";
import { NeedsServer } from "../ui/server_gone";

export interface FileActsProps {
  api: Api;
  project: Project;
  refresh: () => Promise<void>;
  /** What was deleted, so that it can be brought back. */
  onDeleted: (file: FileAnswer) => void;
  onRefused: (why: string) => void;
}

type Asked = "rename" | "duplicate" | null;

/** What can be done with a file besides opening it. */
export function FileActs(props: FileActsProps & { name: string }) {
  const { api, name, refresh, onDeleted, onRefused } = props;
  const [isOpen, setIsOpen] = useState(false);
  const [asked, setAsked] = useState<Asked>(null);
  const remove = async () => {
    try {
      const file = await api.read(name);
      await api.ask("POST /api/file/delete", { name, base_hash: file.hash });
      onDeleted(file);
    } catch (error) {
      onRefused(refusal(error));
    }
    await refresh();
  };
  return (
    <>
      <Button
        label="…"
        class="more"
        aria-label={`More for ${name}`}
        title="Rename, duplicate or delete"
        aria-expanded={isOpen}
        onClick={() => setIsOpen(!isOpen)}
      />
      {isOpen && (
        <span class="file-acts">
          <NeedsServer changes>
            <Button label="Rename" aria-label={`Rename ${name}`} onClick={() => setAsked("rename")} />
            <Button label="Duplicate" aria-label={`Duplicate ${name}`} onClick={() => setAsked("duplicate")} />
            <Button label="Delete" aria-label={`Delete ${name}`} onClick={() => void remove()} />
          </NeedsServer>
        </span>
      )}
      {asked !== null && <NameDialog {...props} isCopy={asked === "duplicate"} onClose={() => setAsked(null)} />}
    </>
  );
}

/** Asks for a name, for a copy or for the file itself. */
function NameDialog(props: FileActsProps & { name: string; isCopy: boolean; onClose: () => void }) {
  const { api, name, isCopy, project, refresh, onClose } = props;
  const [problem, setProblem] = useState("");
  const followers = followersOf(name, useRobot().robots.value?.robots ?? []);
  const ending = name.slice(name.lastIndexOf("."));
  const call = async (form: FormData) => {
    const typed = String(form.get("name")).trim();
    const wanted = typed.endsWith(ending) ? typed : typed + ending;
    setProblem(
      await refusalOf(async () => {
        const asked = { name, new_name: wanted };
        if (isCopy) await api.ask("POST /api/file/copy", asked);
        else if (wanted !== name) {
          const { hash } = await api.read(name);
          await api.ask("POST /api/file/rename", { ...asked, base_hash: hash });
        }
        onClose();
      }),
    );
    await refresh();
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
      <Problem text={problem} />
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
