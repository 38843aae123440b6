// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import { Refused, refusalOf } from "../api/client";
import type { FileAnswer } from "../api/types";
import { FileLists } from "../panels/file_lists";
import { RECIPES } from "../recipes/recipes";
import { href, toRoute } from "../route";
import { FormDialog, typedName } from "../ui/dialog";
import { fileText, useDroppedFile } from "../ui/files";
import { Header } from "../ui/header";
import { Notice } from "../ui/notice";
import { counted } from "../ui/numbers";
import type { PageProps } from "./page_props";

const EMPTY_RULES = "begin\nend\n";

interface HomeProps extends PageProps {
  /** The file that the address named and that is not there, "" for none. */
  missing: string;
}

export function HomePage({ api, project, refresh, editors, missing }: HomeProps) {
  const [creating, setCreating] = useState(false);
  const [refused, setRefused] = useState("");
  const [doing, setDoing] = useState("");
  const { deleted } = editors;
  const last = deleted.value.at(-1);
  const before = deleted.value.length - 1;
  const take = async (file: File) => {
    const why = await refusalOf(async () => {
      if (/\.bag$/.test(file.name)) throw new Refused(ros1Words(file.name));
      if (/\.(mcap|db3)$/.test(file.name)) {
        setDoing(`Copying ${file.name} into ${project.root_name} …`);
        const added = await api.addRecording(file).finally(() => setDoing(""));
        await refresh();
        return toRoute({ page: "recordings", name: added.bag });
      }
      const { name, text } = await fileText(file);
      if (project.files.some((each) => each.name === name)) {
        throw new Refused(`${project.root_name} has a ${name} already: choose another name`);
      }
      await api.save(name, text, null);
      await refresh();
      toRoute({ page: name.endsWith(".toml") ? "topics" : "rules", name });
    });
    if (why !== "") setRefused(why);
  };
  useDroppedFile((file) => void take(file));
  const bringBack = async (file: FileAnswer) => {
    // At once: a second click is for the file before.
    deleted.value = deleted.value.filter((each) => each !== file);
    const why = await refusalOf(() => api.save(file.name, file.text, null));
    setRefused(why);
    if (why !== "") deleted.value = [...deleted.value, file];
    await refresh();
  };
  return (
    <>
      <Header title="ADIRF Ruler" note={project.root_name} isStart />
      <main class="home">
        {doing && <p role="status">{doing}</p>}
        {refused && <Notice kind="error" text={refused} action={{ label: "Close", act: () => setRefused("") }} />}
        {missing && (
          <Notice kind="warning" text={`${project.root_name} has no ${missing}: it was renamed, moved or deleted`} />
        )}
        {last && (
          <Notice
            kind="info"
            text={`${last.name} is deleted${before > 0 ? `, and before it ${counted(before, "file")}` : ""}`}
            action={{ label: "Undo", act: () => bringBack(last) }}
          />
        )}
        <FileLists
          {...{ api, project, refresh, editors, onRefused: setRefused }}
          onDeleted={(file) => (deleted.value = [...deleted.value, file])}
          onNew={() => setCreating(true)}
        />
        <footer class="quiet">
          SmartTestudo {project.version} · {project.ros ? "ROS 2 found" : "works without ROS 2"} ·{" "}
          <a href={href({ page: "tour", name: "" })}>Take the tour</a>
        </footer>
        {creating && <NewRules {...{ api, project, refresh }} onClose={() => setCreating(false)} />}
      </main>
    </>
  );
}

function ros1Words(name: string): string {
  const convert = `rosbags-convert --src ${name} --dst ${name.replace(/\.bag$/, "")}`;
  return `${name} is a ROS 1 bag. Convert it in a terminal, then drop the file of the new folder: ${convert}`;
}

function aboutOf(recipe: string): string {
  return RECIPES.find(({ title }) => title === recipe)?.about ?? "";
}

function NewRules(props: Pick<PageProps, "api" | "refresh" | "project"> & { onClose: () => void }) {
  const [about, setAbout] = useState("");
  const create = async (form: FormData) => {
    const name = typedName(form, ".adirf");
    const recipe = RECIPES.find(({ title }) => title === form.get("recipe"));
    await props.api.save(name, recipe?.text ?? EMPTY_RULES, null);
    await props.refresh();
    toRoute({ page: "rules", name });
  };
  return (
    <FormDialog title="New Rule File" submit="Create" onSubmit={create} onClose={props.onClose}>
      <label>
        Name
        <input name="name" required autofocus placeholder="warehouse" autocomplete="off" />
      </label>
      <label>
        Start from a recipe
        <select name="recipe" onChange={(event) => setAbout(aboutOf(event.currentTarget.value))}>
          <option value="">No recipe: begin with an empty file</option>
          {RECIPES.map(({ title }) => (
            <option key={title}>{title}</option>
          ))}
        </select>
      </label>
      {about && <p>{about}</p>}
      <p class="quiet">It is created in {props.project.root_name}; a / in the name puts it into a folder.</p>
    </FormDialog>
  );
}
