// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from "preact/hooks";
import type { FoundFile, Project } from "../api/types";
import type { KeptIncidents } from "../incidents/kept_incidents";
import type { RuleEditor } from "../state/rule_editor";
import { FolderTrial, Trial, totalOf } from "../state/trial";
import {
  ALL,
  bagsIn,
  changedSince,
  type FileTries,
  fileOf,
  foldersIn,
  folderWords,
  recordingOf,
  recordingsIn,
  type Tried,
} from "../state/tries";
import { FolderResult } from "../try/folder_result";
import { TryResult } from "../try/try_result";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { NeedsServer } from "../ui/connection";
import { byFolder } from "../ui/files";
import { WorkProgress } from "../ui/notice";
import { counted } from "../ui/numbers";
import { focusIn } from "../ui/watch";

interface Props {
  editor: RuleEditor;
  project: Project;
  tries: FileTries;
  keptIncidents: KeptIncidents;
  refresh: () => Promise<void>;
}

/** What the rules would have done to a recording, or to each in a folder. */
export function TryPanel(props: Props) {
  const { editor, project, tries, refresh } = props;
  // A recording may have been changed, or come, since the page was opened.
  useEffect(() => void refresh(), []);
  const bags = bagsIn(project.files);
  if (bags.length === 0) {
    return (
      <p class="quiet">
        No recording in {project.root_name}. Put a rosbag2 folder there (or run <code>testudo demo</code>) and open this
        page again.
      </p>
    );
  }
  const folders = foldersIn(project.files, tries.folder.value?.folder);
  const chosen = tries.chosen.value;
  const folder = folders.find(([name]) => name === chosen)?.[0] ?? null;
  const bag = recordingOf(bags, tries, editor.rules, editor.map.value.bag);
  // The project's own first: a robot's incidents are in a folder of theirs.
  const listed = [...byFolder(bags.map((name) => ({ name }))).values()].flat().map(({ name }) => name);
  const work = folder === null ? tries.work : tries.folderWork;
  const isRunning = work.state.value.kind === "running";
  return (
    <div class="try">
      <div class="row">
        <Choice
          label="Recording"
          value={folder ?? bag}
          choices={[...folders.map(([name, count]) => [name, choiceWords(name, count, project)] as const), ...listed]}
          disabled={isRunning}
          choose={(name) => (tries.chosen.value = name)}
        />
        {!isRunning && (
          <NeedsServer>
            <Button
              label={folder === null ? "Run the rules on it" : "Run the rules on them"}
              class="primary"
              onClick={() => void (folder === null ? tryRecording(props, bag) : tryFolder(props, folder))}
            />
          </NeedsServer>
        )}
        <WorkProgress<unknown>
          work={work}
          doing={folder === null ? `Replaying ${bag}` : `Replaying the recordings of ${folderWords(folder)}`}
        />
      </div>
      {folder === null ? <LastTry {...props} /> : <LastFolder {...props} />}
    </div>
  );
}

function tryRecording({ editor, tries }: Props, bag: string): Promise<void> {
  const { api } = editor;
  return tries.work.start(async (run, signal) => {
    const rules = await editor.settledRules();
    const { files } = await api.project();
    const answer = await api.ask("POST /api/try", { ...rules, bag, run }, { signal });
    tries.remember(bag, answer);
    return new Trial(answer, rules, bag, [fileOf(bag, files)]);
  });
}

/** Results show as they come. */
function tryFolder({ editor, tries }: Props, folder: string): Promise<void> {
  const { api } = editor;
  let share = (_ofOne: number, _number: number) => 0;
  return tries.folderWork.start(
    async (run, signal, setShare) => {
      const rules = await editor.settledRules();
      const { files } = await api.project();
      signal.throwIfAborted();
      const trial = new FolderTrial(folder, rules, recordingsIn(folder, files));
      share = (ofOne, number) => trial.share(ofOne, number);
      tries.folder.value = trial;
      const done = await trial.run(api, run, signal, setShare);
      tries.remember(folder, totalOf(done.rows.peek()));
      return done;
    },
    (ofOne, number) => share(ofOne, number),
  );
}

function choiceWords(folder: string, count: number, { has_more, root_name }: Project): string {
  // A project that holds more files than are listed may have recordings among those.
  const which = has_more ? "the listed" : "all";
  return `${folder === ALL ? root_name : folder}: ${which} ${counted(count, "recording")}`;
}

function LastTry({ editor, project, tries, keptIncidents }: Props) {
  const [trial, folder] = [tries.last.value, tries.folder.value?.folder];
  const back = useRef<HTMLParagraphElement>(null);
  // After the table nothing has the focus: the button that had it is gone.
  useEffect(() => focusIn(back.current, "button"), []);
  return (
    <>
      {folder !== undefined && (
        <p class="back-to-folder" ref={back}>
          <Button
            label={`Back to the recordings of ${folderWords(folder)}`}
            class="small"
            onClick={() => (tries.chosen.value = folder)}
          />
        </p>
      )}
      {trial !== null && (
        <TryResult
          key={trial.bag}
          {...{ editor, trial, keptIncidents }}
          changed={changed(editor, trial, [fileOf(trial.bag, project.files)])}
        />
      )}
    </>
  );
}

function LastFolder(props: Props) {
  const { editor, project, tries } = props;
  const trial = tries.folder.value;
  if (trial === null) return null;
  return (
    <FolderResult
      trial={trial}
      isRunning={tries.folderWork.state.value.kind === "running"}
      changed={changed(editor, trial, recordingsIn(trial.folder, project.files))}
      opened={tries.last.value?.bag}
      open={(bag) => {
        tries.chosen.value = bag;
        void tryRecording(props, bag);
      }}
    />
  );
}

function changed(editor: RuleEditor, tried: Tried, recordings: readonly (FoundFile | undefined)[]): string[] {
  return editor.profileChoice.isKnown.value ? changedSince(tried, editor.rules, recordings) : [];
}
