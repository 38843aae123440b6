// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import { Refused, refusalOf } from "../api/client";
import { type Conflict, isStatus, type OpenFile } from "../state/open_file";
import { Button } from "./button";
import { NeedsServer, useRobot } from "./connection";
import { FormDialog, typedName } from "./dialog";
import { DifferenceWords, TextComparison } from "./difference_words";
import { Notice } from "./notice";
import { useUndoKeys } from "./watch";

const LOOK_MS = 4000;

/** Brings the keys of a file that is open, and looks at it on disk every few seconds and when somebody comes back. */
export function useOpenFile(file: OpenFile, save: () => Promise<void>): void {
  const link = useRobot();
  const isOpen = file.isOpen.value;
  useUndoKeys({ undo: () => file.undo(), redo: () => file.redo(), save: () => save() });
  useEffect(() => {
    if (!isOpen) return;
    const look = () => {
      // What is refused, the next look says, or the server is gone.
      if (!document.hidden && !link.isServerGone.peek()) void refusalOf(() => file.lookAtDisk());
    };
    const timer = setInterval(look, LOOK_MS);
    addEventListener("focus", look);
    return () => {
      clearInterval(timer);
      removeEventListener("focus", look);
    };
  }, [isOpen]);
}

interface Props {
  file: OpenFile;
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
  const guarded = async (work: () => Promise<unknown>) => {
    setProblem(await refusalOf(work));
  };
  const saveAs = async (form: FormData) => {
    const name = typedName(form, ending);
    await file.saveAs(name).catch((error: unknown) => {
      throw isStatus(error, 409) ? new Refused(`${name} exists already: choose another name`) : error;
    });
    await onSavedAs(name);
  };
  const isGone = conflict.theirs === null;
  return (
    <FormDialog
      title={isGone ? `${file.name} is no longer there` : `Somebody else changed ${file.name}`}
      submit="Save as"
      isWide
      canSubmit={!useRobot().onlyWatches.value}
      problem={problem}
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
            api={file.api}
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
    </FormDialog>
  );
}

const RESTORED_TIME = { dateStyle: "medium", timeStyle: "short" } as const;

/** What to know of a file that is open: what of it was restored, and what happened to it on disk. */
export function FileNotices({ file }: { file: OpenFile }) {
  return (
    <>
      <RestoredNotice file={file} />
      <DiskNotice file={file} />
    </>
  );
}

/** Says that a draft was restored, until it is saved, dropped or closed. */
function RestoredNotice({ file }: { file: OpenFile }) {
  const restored = file.restored.value;
  if (restored === null) return null;
  const when = new Date(restored.changedMs).toLocaleString("en-GB", RESTORED_TIME);
  return (
    <div class="notice warning restored" role="status">
      <span>
        Your unsaved changes of {when} are restored.
        {restored.isContested && " Somebody else changed the file since: a save asks what to do."}
      </span>
      <span class="row">
        {restored.isContested && <Button label="Compare" class="small" onClick={() => void file.compare()} />}
        <Button label="Drop them" class="small" onClick={() => void file.attempt(() => file.dropRestored())} />
        <Button label="Close" class="small" onClick={() => (file.restored.value = null)} />
      </span>
    </div>
  );
}

/** Says that somebody else changed a file of which something here is not saved. */
function DiskNotice({ file }: { file: OpenFile }) {
  const change = file.diskChange.value;
  if (change === null) return null;
  if (change === "gone") return <Notice kind="warning" text={`${file.name} is no longer on disk: a save writes it.`} />;
  const text = `Somebody else changed ${file.name} on disk; what you changed here is not saved.`;
  return <Notice kind="warning" text={text} action={{ label: "Compare", act: () => file.compare() }} />;
}
