// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useId, useState } from "preact/hooks";
import { type Api, Refused, refusalOf } from "../api/client";
import type { FileAnswer, Project } from "../api/types";
import { openDocumentation } from "../documentation";
import { FileLists } from "../panels/file_lists";
import { ownProfile } from "../panels/profile_choice";
import { RecordingList, RecordingStart } from "../panels/project_start";
import { RECIPES } from "../recipes/recipes";
import { href, NEW_PROFILE, type Route, toRoute } from "../route";
import { Button } from "../ui/button";
import { NeedsServer, RobotState } from "../ui/connection";
import { FormDialog, typedName } from "../ui/dialog";
import { fileText, useDroppedFile } from "../ui/files";
import { Notice } from "../ui/notice";
import { counted } from "../ui/numbers";
import type { PageProps } from "./page_props";

const EMPTY_RULES = "begin\nend\n";

interface HomeProps extends PageProps {
  /** The file that the address named and that is not there, "" for none. */
  missing: string;
}

export function HomePage({ api, project, refresh, editors, missing }: HomeProps) {
  /** The recipe that new rules start from, "" for none. */
  const [creating, setCreating] = useState<string | null>(null);
  const [refused, setRefused] = useState("");
  /** The recording that rules are to start from. */
  const [bag, setBag] = useState<string | null>(null);
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
        return setBag(added.bag);
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
  // In a project with files these come first, in a new one the ways to begin.
  const hasFiles = project.files.some(({ kind }) => kind === "rules" || kind === "profile");
  return (
    <main class="home">
      <RobotState />
      <div class={hasFiles ? "hero small" : "hero"}>
        <img src="./icon.svg" alt="" width="56" height="56" />
        <h1 tabIndex={-1}>ADIRF Ruler</h1>
        <p>Say how often each topic of your robot is worth sending, and when. No programming needed.</p>
      </div>
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
      {hasFiles && (
        <FileLists
          {...{ api, project, refresh, editors, onRefused: setRefused }}
          onDeleted={(file) => (deleted.value = [...deleted.value, file])}
          onNew={() => setCreating("")}
        />
      )}
      {hasFiles && <SavesByItself {...{ api, project }} onSet={refresh} onRefused={setRefused} />}
      <nav class="cards" aria-label="Start">
        {!hasFiles && (
          <NeedsServer changes>
            <Card
              isFirstStep
              title="New Rule File"
              text="Build rules from blocks, check them, try them on a recording."
              act={() => setCreating("")}
            />
          </NeedsServer>
        )}
        <Card
          title="Configure Topic Parameters"
          text="Message sizes, the six quality levels and the bandwidth of the link."
          act={() => toRoute(tableOf(project))}
        />
        <Card
          title="Watch Robots"
          text="Every robot that is heard: its link, its rules and what arrives late."
          act={() => toRoute({ page: "robots", name: "" })}
        />
        <Card
          title="Look at Incidents"
          text="What rules recorded around the moment that mattered, and why."
          act={() => toRoute({ page: "incidents", name: "" })}
        />
        <Card
          title="Documentation"
          text="The language, findings, units and keys, with a search. It needs no network."
          act={() => openDocumentation()}
        />
      </nav>
      <NeedsServer changes>
        <section class="recipes" aria-label="Recipes">
          <h2>Start from a recipe</h2>
          <div class="row">
            {RECIPES.map(({ title }) => (
              <Button label={title} key={title} onClick={() => setCreating(title)} />
            ))}
          </div>
        </section>
        <RecordingList project={project} onStart={setBag} />
      </NeedsServer>
      <footer class="quiet">
        {project.root_name} · SmartTestudo {project.version} · {project.ros ? "ROS 2 found" : "works without ROS 2"} ·{" "}
        <a href={href({ page: "tour", name: "" })}>Take the tour</a>
      </footer>
      {bag !== null && <RecordingStart {...{ api, project, refresh, bag }} onClose={() => setBag(null)} />}
      {creating !== null && (
        <NewRules {...{ api, project, refresh }} recipe={creating} onClose={() => setCreating(null)} />
      )}
    </main>
  );
}

function ros1Words(name: string): string {
  const convert = `rosbags-convert --src ${name} --dst ${name.replace(/\.bag$/, "")}`;
  return `${name} is a ROS 1 bag. Convert it in a terminal, then drop the file of the new folder: ${convert}`;
}

/** The table of topic parameters to open: the first, else a new one, for the rules where there is but one file of them. */
function tableOf({ files }: Project): Route {
  const known = files.find(({ kind }) => kind === "profile");
  if (known) return { page: "topics", name: known.name };
  const [rules, another] = files.filter(({ kind }) => kind === "rules");
  if (rules === undefined || another) return { page: "topics", name: NEW_PROFILE };
  return { page: "topics", name: ownProfile(rules.name), rules: rules.name };
}

interface CardProps {
  title: string;
  text: string;
  act: () => void;
  /** Whether somebody begins with it. */
  isFirstStep?: boolean;
}

function Card({ title, text, act, isFirstStep = false }: CardProps) {
  const id = useId();
  return (
    <div class={isFirstStep ? "card first-step" : "card"}>
      <Button label={title} aria-describedby={id} onClick={act} />
      <p id={id}>{text}</p>
    </div>
  );
}

interface SavesProps {
  api: Api;
  project: Project;
  onSet: () => Promise<void>;
  onRefused: (why: string) => void;
}

/** Whether changes are saved without being asked: a setting of the project. */
function SavesByItself({ api, project, onSet, onRefused }: SavesProps) {
  const set = async (isWanted: boolean) => {
    const why = await refusalOf(async () => {
      await api.ask("PUT /api/project/settings", { saves_by_itself: isWanted });
      await onSet();
    });
    if (why !== "") onRefused(why);
  };
  return (
    <NeedsServer changes>
      <label class="setting">
        <input
          type="checkbox"
          checked={project.saves_by_itself}
          onChange={(event) => void set(event.currentTarget.checked)}
        />
        Save by itself, two seconds after the last change without errors
      </label>
    </NeedsServer>
  );
}

function aboutOf(recipe: string): string {
  return RECIPES.find(({ title }) => title === recipe)?.about ?? "";
}

function NewRules(props: Pick<PageProps, "api" | "refresh" | "project"> & { recipe: string; onClose: () => void }) {
  const [about, setAbout] = useState(aboutOf(props.recipe));
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
            <option key={title} selected={title === props.recipe}>
              {title}
            </option>
          ))}
        </select>
      </label>
      {about && <p>{about}</p>}
      <p class="quiet">It is created in {props.project.root_name}; a / in the name puts it into a folder.</p>
    </FormDialog>
  );
}
