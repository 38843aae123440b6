// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useEffect } from "preact/hooks";
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import type { Keepings } from "../state/keepings";
import type { RuleEditor } from "../state/rule_editor";
import { Trial } from "../state/trial";
import { bagsIn, changedSince, type FileTries, fileOf, recordingOf } from "../state/tries";
import { TryResult } from "../try/try_result";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { NeedsServer } from "../ui/server_gone";
import { WorkProgress } from "../ui/work_progress";

interface Props {
  editor: RuleEditor;
  api: Api;
  project: Project;
  tries: FileTries;
  keepings: Keepings;
  refresh: () => Promise<void>;
}

/** What the rules would have done to a recording. */
export function TryPanel({ editor, api, project, tries, keepings, refresh }: Props) {
  useEffect(() => {
    // A recording may have been changed, or come, while nobody looked.
    const look = () => void refresh();
    look();
    addEventListener("focus", look);
    return () => removeEventListener("focus", look);
  }, []);
  const bags = bagsIn(project.files);
  if (bags.length === 0) {
    return (
      <p class="quiet">
        No recording in {project.root_name}. Put a rosbag2 folder there (or run <code>testudo demo</code>) and open this
        page again.
      </p>
    );
  }
  const { work, last } = tries;
  const trial = last.value;
  const { rules } = editor;
  const bag = recordingOf(bags, tries, rules, editor.map.value.bag);
  const isRunning = work.state.value.kind === "running";
  const run = () =>
    work.start(async (name, signal) => {
      const { files } = await api.project();
      const answer = await api.ask("POST /api/try", { ...rules, bag, run: name }, { signal });
      return new Trial(answer, rules, bag, fileOf(bag, files));
    });
  return (
    <div class="try">
      <div class="row">
        <Choice
          label="Recording"
          value={bag}
          choices={bags}
          disabled={isRunning}
          choose={(name) => (tries.bag.value = name)}
        />
        {!isRunning && (
          <NeedsServer>
            <Button label="Run the rules on it" class="primary" onClick={() => void run()} />
          </NeedsServer>
        )}
        <WorkProgress work={work} doing={`Replaying ${bag}`} />
      </div>
      {trial !== null && (
        <TryResult
          key={trial.bag}
          {...{ editor, api, trial, keepings }}
          changed={editor.profileChoice.isKnown.value ? changedSince(trial, rules, project.files) : []}
        />
      )}
    </div>
  );
}
