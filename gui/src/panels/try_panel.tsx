// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import type { BagWork } from "../state/bag_work";
import type { RuleEditor } from "../state/rule_editor";
import { Trial } from "../state/trial";
import { TryResult } from "../try/try_result";
import { NeedsServer } from "../ui/server_gone";
import { WorkProgress } from "../ui/work_progress";

/** What the rules would have done to a recording. */
export function TryPanel(props: { editor: RuleEditor; api: Api; project: Project; work: BagWork<Trial> }) {
  const { editor, api, project, work } = props;
  const bags = project.files
    .filter((file) => file.kind === "bag")
    .sort((a, b) => b.size_bytes - a.size_bytes)
    .map((file) => file.name);
  const state = work.state.value;
  const [bag, setBag] = useState((state.kind === "done" ? state.answer.bag : bags[0]) ?? "");
  if (bags.length === 0) {
    return (
      <p class="quiet">
        No recording in {project.root_name}. Put a rosbag2 folder there (or run <code>testudo demo</code>) and open this
        page again.
      </p>
    );
  }
  const run = () =>
    work.start(async (name, signal) => {
      const { rules } = editor;
      return new Trial(await api.tryOnBag(rules, bag, name, signal), rules, bag);
    });
  return (
    <div class="try">
      <div class="row">
        <label>
          Recording
          <select value={bag} onChange={(event) => setBag(event.currentTarget.value)}>
            {bags.map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
        {state.kind !== "running" && (
          <NeedsServer>
            <button type="button" class="primary" onClick={() => void run()}>
              Run the rules on it
            </button>
          </NeedsServer>
        )}
        <WorkProgress work={work} doing={`Replaying ${bag}`} />
      </div>
      {state.kind === "done" && <TryResult key={state.answer.bag} {...{ editor, api }} trial={state.answer} />}
    </div>
  );
}
