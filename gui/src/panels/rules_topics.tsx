// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import type { Api } from "../api/client";
import { refusal } from "../api/refusal";
import { href } from "../route";
import type { OpenEditors } from "../state/open_editors";
import type { ProfileEditor } from "../state/profile_editor";
import { topicsIn } from "../state/topics_in";

interface Props {
  api: Api;
  editors: OpenEditors;
  editor: ProfileEditor;
  /** The rule file that the table is for. */
  rules: string;
}

/** The way back to the rules, and a row for each topic of them that the table lacks; a new table begins with those. */
export function RulesTopics({ api, editors, editor, rules }: Props) {
  const [topics, setTopics] = useState<readonly string[]>([]);
  const [problem, setProblem] = useState("");
  useEffect(() => {
    topicsOf(api, editors, rules).then(
      (found) => {
        setTopics(found);
        const isEmpty = editor.rows.peek().every((row) => row.topic.trim() === "");
        if (editor.isNew.peek() && editor.isSaved.peek() && isEmpty && found.length > 0) editor.begin(found);
      },
      (error: unknown) => {
        setProblem(refusal(error));
      },
    );
  }, []);
  const known = new Set(editor.rows.value.map((row) => row.topic.trim()));
  const missing = topics.filter((topic) => !known.has(topic));
  return (
    <div class="row">
      <a href={href({ page: "rules", name: rules })}>Back to {rules}</a>
      {problem && <p class="problem">{problem}</p>}
      {missing.length > 0 && (
        <>
          <p role="status">
            {missing.length === 1 ? "1 topic of the rules is" : `${missing.length} topics of the rules are`} not in the
            table.
          </p>
          <button type="button" class="small" onClick={() => editor.addTopics(missing)}>
            Add {missing.length === 1 ? missing[0] : "them"}
          </button>
        </>
      )}
    </div>
  );
}

async function topicsOf(api: Api, editors: OpenEditors, rules: string): Promise<string[]> {
  const text = editors.unsavedText(rules) ?? (await api.read(rules)).text;
  return [...topicsIn(await api.document({ text, name: rules, profile_text: null }))].sort();
}
