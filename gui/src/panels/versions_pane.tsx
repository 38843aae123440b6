// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useSignal } from "@preact/signals";
import { refusalOf } from "../api/client";
import type { RuleVersion } from "../api/types";
import type { RuleEditor } from "../state/rule_editor";
import { Button } from "../ui/button";
import { NeedsServer, useReturn } from "../ui/connection";
import { DifferenceWords, TextComparison } from "../ui/difference_words";
import { useAnswer } from "../ui/later";
import { Problem } from "../ui/notice";
import { moment } from "../ui/numbers";

const SHOWN_CHANGES = 5;

/** What was saved or given up of the rule file: when, what changed in words, and the way back. */
export function VersionsPane({ editor }: { editor: RuleEditor }) {
  // Each save makes a version.
  const { answer, problem, again } = useAnswer(() => editor.api.versions(editor.name), [editor.savedContent.value]);
  useReturn(again);
  const refused = useSignal("");
  /** The version that is compared with what is open, and its text. */
  const compared = useSignal<{ id: string; text: string } | null>(null);
  const guarded = async (work: () => Promise<unknown>) => {
    refused.value = await refusalOf(work);
  };
  const textOf = async (id: string) => (await editor.api.ask("POST /api/version", { name: editor.name, id })).text;
  const compare = (id: string) =>
    guarded(async () => (compared.value = compared.peek()?.id === id ? null : { id, text: await textOf(id) }));
  const bringBack = (id: string) =>
    guarded(async () => {
      const text = await textOf(id);
      compared.value = null;
      await editor.replaceUnsaved(text);
      await again();
    });
  if (answer === null) return <p class="quiet versions-pane">{problem || "Reading the versions …"}</p>;
  const { versions, most, folder } = answer;
  return (
    <section class="versions-pane" aria-label="Versions">
      <Problem text={problem || refused.value} />
      {versions.length === 0 && <p class="quiet">None yet: each save of this file keeps one.</p>}
      <ol class="version-list">
        {versions.map((version, index) => (
          <li key={version.id} aria-label={titleOf(version)}>
            <div class="row">
              <strong>{moment(version.saved_at_ms)}</strong>
              {index === 0 && <span class="quiet">the newest</span>}
              <span class="version-tools">
                <NeedsServer>
                  <Button
                    label="Compare"
                    class="small"
                    aria-expanded={compared.value?.id === version.id}
                    onClick={() => void compare(version.id)}
                  />
                  <NeedsServer changes>
                    <Button label="Bring back" class="small" onClick={() => void bringBack(version.id)} />
                  </NeedsServer>
                </NeedsServer>
              </span>
            </div>
            <Changes version={version} isOldest={index === versions.length - 1} />
            {compared.value?.id === version.id && <Comparison {...{ editor, version }} text={compared.value.text} />}
          </li>
        ))}
      </ol>
      <p class="quiet">
        At most {most} versions are kept, in {folder} of the project. What is brought back is not saved yet; what was
        not saved before is a version.
      </p>
    </section>
  );
}

function titleOf(version: RuleVersion): string {
  return `Version of ${moment(version.saved_at_ms)}`;
}

/** What changed in a version, as a robot sees it. */
function Changes({ version: { changes, parses }, isOldest }: { version: RuleVersion; isOldest: boolean }) {
  if (changes === null) {
    return <p class="quiet">{isOldest ? "The oldest that is kept." : "Not compared in words: the files are large."}</p>;
  }
  const more = changes.length - SHOWN_CHANGES;
  return (
    <>
      {changes.length === 0 && parses && <p class="quiet">Comments, layout or order only.</p>}
      <ul>
        {changes.slice(0, SHOWN_CHANGES).map((each) => (
          <li key={each}>{each}</li>
        ))}
        {more > 0 && <li class="quiet">and {more} more</li>}
      </ul>
      {parses === false && <p class="quiet">It has errors of syntax.</p>}
    </>
  );
}

interface ComparisonProps {
  editor: RuleEditor;
  version: RuleVersion;
  text: string;
}

function Comparison({ editor, version, text }: ComparisonProps) {
  const now = editor.text.value;
  if (text === now) return <p role="status">This is what is open.</p>;
  return (
    <div class="version-comparison" role="status">
      <DifferenceWords api={editor.api} title="Bringing it back changes for a robot:" oldText={now} newText={text} />
      <TextComparison a="Open now" textA={now} b={moment(version.saved_at_ms)} textB={text} />
    </div>
  );
}
