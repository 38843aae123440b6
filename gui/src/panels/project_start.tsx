// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Api, Refused } from "../api/client";
import type { Project } from "../api/types";
import { toRoute } from "../route";
import { layoutName, PLAIN_GRID, writeLayout } from "../state/layout";
import { FormDialog, typedName } from "../ui/dialog";
import { baseName } from "../ui/files";
import { useAnswer } from "../ui/later";
import { counted, durationWords } from "../ui/numbers";
import { ownProfile } from "./profile_choice";

interface Props {
  api: Api;
  project: Project;
  refresh: () => Promise<void>;
}

/** Makes rules, topic parameters and a map of what a recording holds. */
export function RecordingStart({ bag, ...props }: Props & { bag: string; onClose: () => void }) {
  const { api } = props;
  const origin: Origin = {
    title: bag,
    name: baseName(bag).replace(/\.(mcap|db3)$/, ""),
    bag,
    read: async () => {
      const { topics, duration_s, rules_text } = await api.ask("POST /api/recording", { bag });
      const said = `${counted(topics.length, "topic")}, ${durationWords(duration_s)}.`;
      const profile = async () => (await api.ask("POST /api/profile/measure", { bag })).text;
      return { said, rules_text, profile };
    },
  };
  return <StartDialog origin={origin} {...props} />;
}

/** Makes rules and topic parameters of what a robot relays now. */
export function RobotStart({ node, label, ...props }: Props & { node: string; label: string; onClose: () => void }) {
  const { api } = props;
  const origin: Origin = {
    title: label,
    name: label.split("/").find((part) => part !== "") ?? "robot",
    bag: null,
    read: async () => {
      const { topics, rules_text, profile_text } = await api.ask("POST /api/robot/start", { node });
      return { said: `${counted(topics.length, "topic")} relayed now.`, rules_text, profile: async () => profile_text };
    },
  };
  return <StartDialog origin={origin} {...props} />;
}

/** What rules can start from; `bag` has a path to show. */
interface Origin {
  title: string;
  name: string;
  bag: string | null;
  read: () => Promise<Found>;
}

interface Found {
  said: string;
  rules_text: string;
  /** Topic parameters; measuring them may take long. */
  profile: () => Promise<string>;
}

function StartDialog({ api, project, refresh, origin, onClose }: Props & { origin: Origin; onClose: () => void }) {
  const { answer: found, problem } = useAnswer(() => origin.read());
  const create = async (form: FormData) => {
    if (found === null) return;
    const name = typedName(form, ".adirf");
    const wanted = (what: string) => form.get(what) !== null;
    const taken = [name, ...(wanted("sizes") ? [ownProfile(name)] : [])].find((one) =>
      project.files.some((file) => file.name === one),
    );
    if (taken !== undefined) throw new Refused(`${taken} exists already: choose another name`);
    // Measured first: what cannot be read leaves nothing behind.
    const sizes = wanted("sizes") ? await found.profile() : null;
    await api.save(name, wanted("defaults") ? found.rules_text : "begin\nend\n", null);
    if (sizes !== null) await api.save(ownProfile(name), sizes, null);
    if (wanted("path")) await writeLayout(api, layoutName(name), { ...PLAIN_GRID, bag: origin.bag }, null);
    await refresh();
    toRoute({ page: "rules", name });
  };
  return (
    <FormDialog
      title={`Start from ${origin.title}`}
      submit="Create"
      canSubmit={found !== null}
      problem={problem}
      onSubmit={create}
      onClose={onClose}
    >
      <p role="status">{found?.said ?? "Reading …"}</p>
      <label>
        Name
        <input name="name" required autocomplete="off" defaultValue={origin.name} />
      </label>
      <div class="checklist">
        <Choice name="defaults" label="Make defaults" note="every message of each topic, to lower from there" />
        <Choice name="sizes" label="Measure sizes" note="topic parameters, in a profile of the same name" />
        {origin.bag !== null && <Choice name="path" label="Show the path" note="below the zones on the map" />}
      </div>
    </FormDialog>
  );
}

function Choice({ name, label, note }: { name: string; label: string; note: string }) {
  return (
    <label>
      <input type="checkbox" name={name} defaultChecked />
      {label}
      <span class="quiet">{note}</span>
    </label>
  );
}
