// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import { type Api, ApiError } from "../api/client";
import { type Conflict, isStatus, type OpenFile } from "../state/open_file";
import { Button } from "./button";
import { FormDialog } from "./dialog";
import { DifferenceWords, TextComparison } from "./difference_words";
import { Problem } from "./notice";
import { useRobot } from "./robot_state";
import { NeedsServer } from "./server_gone";

interface Props {
  api: Api;
  file: OpenFile;
  /** Called with the name of the new file, after the text was saved under it. */
  onSavedAs: (name: string) => unknown;
}

/** Asks what to do when a save met a file that somebody else changed; there only while it has to be asked. */
export function ConflictDialog(props: Props) {
  const conflict = props.file.conflict.value;
  return conflict && <WaysOut {...props} conflict={conflict} />;
}

function WaysOut({ api, file, conflict, onSavedAs }: Props & { conflict: Conflict }) {
  const [problem, setProblem] = useState("");
  const ending = file.name.slice(file.name.lastIndexOf("."));
  const guarded = async (work: () => Promise<unknown>, where = file.name) => {
    try {
      await work();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      setProblem(isStatus(error, 409) ? `${where} exists already: choose another name` : error.message);
    }
  };
  const saveAs = (form: FormData) => {
    const typed = String(form.get("name")).trim();
    const name = typed.endsWith(ending) ? typed : `${typed}${ending}`;
    return guarded(() => file.saveAs(name).then(() => onSavedAs(name)), name);
  };
  const isGone = conflict.theirs === null;
  return (
    <FormDialog
      title={isGone ? `${file.name} is no longer there` : `Somebody else changed ${file.name}`}
      submit="Save as"
      isWide
      canSubmit={!useRobot().onlyWatches.value}
      onSubmit={saveAs}
      onClose={() => (file.conflict.value = null)}
    >
      <p>Nothing was saved, and nothing that you typed is lost.</p>
      {conflict.theirs !== null && (
        <TextComparison a="Theirs" textA={conflict.theirs} b="Yours" textB={conflict.mine} />
      )}
      {conflict.theirs !== null && ending === ".adirf" && (
        // Of one height before and after the answer, so that no button moves away under the mouse.
        // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach
        <div class="conflict-words" role="region" aria-label="What a robot does otherwise" tabIndex={0}>
          <DifferenceWords
            api={api}
            title="With yours, a robot does this otherwise than with theirs:"
            oldText={conflict.theirs}
            newText={conflict.mine}
          />
        </div>
      )}
      <div class="ways">
        {!isGone && <Button label="Read again" onClick={() => void guarded(() => file.readAgain())} />}
        {!isGone && <span>loads their version; Undo restores yours.</span>}
        <NeedsServer changes>
          <Button label="Save anyway" onClick={() => void guarded(() => file.saveAnyway())} />
        </NeedsServer>
        <span>{isGone ? "creates the file again." : "replaces theirs with yours."}</span>
      </div>
      <label>
        {isGone ? "Or save yours under another name" : "Or keep both, yours under another name"}
        <input name="name" required autocomplete="off" placeholder={`mine${ending}`} />
      </label>
      <Problem text={problem} />
    </FormDialog>
  );
}
