// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import { type Api, ApiError } from "../api/client";
import type { Project, TryAnswer } from "../api/types";
import type { RuleEditor } from "../state/rule_editor";
import { TryResult } from "./try_result";

type State = { kind: "idle" } | { kind: "running" } | { kind: "done"; answer: TryAnswer } | { kind: "failed"; why: string };

/** What the rules would have done to a recording. */
export function TryPanel({ editor, api, project }: { editor: RuleEditor; api: Api; project: Project }) {
  const bags = project.files
    .filter((file) => file.kind === "bag")
    .sort((a, b) => b.size_bytes - a.size_bytes)
    .map((file) => file.name);
  const [bag, setBag] = useState(bags[0] ?? "");
  const [state, setState] = useState<State>({ kind: "idle" });
  const running = useRef<AbortController | null>(null);
  useEffect(() => () => running.current?.abort(), []);
  if (bags.length === 0) {
    return (
      <p class="quiet">
        No recording in {project.root_name}. Put a rosbag2 folder there (or run <code>testudo demo</code>) and open this
        page again.
      </p>
    );
  }
  const run = async () => {
    running.current = new AbortController();
    setState({ kind: "running" });
    try {
      setState({ kind: "done", answer: await api.tryOnBag(editor.rules, bag, running.current.signal) });
    } catch (error) {
      if (running.current.signal.aborted) setState({ kind: "idle" });
      else if (error instanceof ApiError) setState({ kind: "failed", why: error.message });
      else throw error;
    }
  };
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
        {state.kind === "running" ? (
          <button type="button" onClick={() => running.current?.abort()}>
            Stop
          </button>
        ) : (
          <button type="button" class="primary" onClick={() => void run()}>
            Run the rules on it
          </button>
        )}
      </div>
      {state.kind === "running" && <p role="status">Replaying {bag} …</p>}
      {state.kind === "failed" && <p class="problem" role="alert">{state.why}</p>}
      {state.kind === "done" && <TryResult answer={state.answer} />}
    </div>
  );
}
