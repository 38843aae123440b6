// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import { ApiError } from "../api/client";
import { type Conflict, type Contested, isStatus } from "../state/conflict";
import { differingLines } from "../text/difference";
import { FormDialog } from "./dialog";

interface Props {
  file: Contested;
  /** Called with the name of the new file, after the text was saved under it. */
  onSavedAs: (name: string) => unknown;
}

/** Asks what to do when a save met a file that somebody else changed; there only while it has to be asked. */
export function ConflictDialog(props: Props) {
  const conflict = props.file.conflict.value;
  return conflict && <WaysOut {...props} conflict={conflict} />;
}

function WaysOut({ file, conflict, onSavedAs }: Props & { conflict: Conflict }) {
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
      onSubmit={saveAs}
      onClose={() => (file.conflict.value = null)}
    >
      <p>Nothing was saved, and nothing that you typed is lost.</p>
      {conflict.theirs !== null && <Versions mine={conflict.mine} theirs={conflict.theirs} />}
      <div class="ways">
        {!isGone && (
          <button type="button" onClick={() => void guarded(() => file.readAgain())}>
            Read again
          </button>
        )}
        {!isGone && <span>loads their version; Undo restores yours.</span>}
        <button type="button" onClick={() => void guarded(() => file.saveAnyway())}>
          Save anyway
        </button>
        <span>{isGone ? "creates the file again." : "replaces theirs with yours."}</span>
      </div>
      <label>
        {isGone ? "Or save yours under another name" : "Or keep both, yours under another name"}
        <input name="name" required autocomplete="off" placeholder={`mine${ending}`} />
      </label>
      {problem && (
        <p class="problem" role="alert">
          {problem}
        </p>
      )}
    </FormDialog>
  );
}

/** The lines in which two texts differ, side by side. */
function Versions({ mine, theirs }: { mine: string; theirs: string }) {
  const { line, a, b } = differingLines(theirs, mine);
  return (
    <div class="versions">
      <Version title={`Theirs, from line ${line}`} text={a} />
      <Version title={`Yours, from line ${line}`} text={b} />
    </div>
  );
}

function Version({ title, text }: { title: string; text: string }) {
  return (
    <figure aria-label={title}>
      <figcaption class="quiet">{title}</figcaption>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach */}
      <pre tabIndex={0}>{text || "(nothing)"}</pre>
    </figure>
  );
}
