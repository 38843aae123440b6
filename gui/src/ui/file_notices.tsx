// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import { refusalOf } from "../api/client";
import type { Conflict, OpenFile } from "../state/open_file";
import { Button } from "./button";
import { NeedsServer, useRobot } from "./connection";
import { FormDialog } from "./dialog";
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

/** Asks what to do with two changes of one file; there only while it has to be asked. */
export function ConflictDialog({ file }: { file: OpenFile }) {
  const conflict = file.conflict.value;
  return conflict && <ChangedElsewhere {...{ file, conflict }} />;
}

function ChangedElsewhere({ file, conflict }: { file: OpenFile; conflict: Conflict }) {
  const [problem, setProblem] = useState("");
  const [isCompared, setCompared] = useState(false);
  const guarded = async (work: () => Promise<unknown>) => setProblem(await refusalOf(work));
  const { mine, theirs, isSave } = conflict;
  const isRules = file.name.endsWith(".adirf");
  return (
    <FormDialog
      title={theirs === null ? `${file.name} is no longer there` : `${file.name} was changed elsewhere`}
      submit="Keep mine"
      isWide={isCompared}
      canSubmit={!useRobot().isServerGone.value && !(isSave && useRobot().onlyWatches.value)}
      problem={problem}
      onSubmit={() => guarded(() => file.keepMine())}
      onClose={() => (file.conflict.value = null)}
    >
      <p>
        Nothing that you typed is lost. <em>Keep mine</em>{" "}
        {isSave
          ? theirs === null
            ? "creates the file again"
            : "saves yours in the place of theirs"
          : "goes on with yours"}
        {theirs !== null && (
          <>
            , <em>Take theirs</em> loads theirs, and Undo brings yours back
          </>
        )}
        .{isRules && theirs !== null && " The other one stays under Versions."}
      </p>
      {isCompared && theirs !== null && (
        <>
          <TextComparison a="Theirs" textA={theirs} b="Yours" textB={mine} />
          {isRules && (
            // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach
            <div class="conflict-words" role="region" aria-label="What a robot does otherwise" tabIndex={0}>
              <DifferenceWords
                api={file.api}
                title="With yours, a robot does this otherwise than with theirs:"
                oldText={theirs}
                newText={mine}
              />
            </div>
          )}
        </>
      )}
      {theirs !== null && (
        <div class="row">
          {!isCompared && <Button label="Look at the difference" onClick={() => setCompared(true)} />}
          <NeedsServer>
            <Button label="Take theirs" onClick={() => void guarded(() => file.discard())} />
          </NeedsServer>
        </div>
      )}
    </FormDialog>
  );
}

const DRAFT_TIME = { dateStyle: "medium", timeStyle: "short" } as const;

/** What to know of a file that is open: whether it is a draft, where that is, and what happened to the file elsewhere. */
export function FileNotices({ file }: { file: OpenFile }) {
  const [ms, change] = [file.restoredMs.value, file.diskChange.value];
  const when = ms && new Date(ms).toLocaleString("en-GB", DRAFT_TIME);
  const elsewhere = `${file.name} was changed elsewhere; what you changed here is not saved.`;
  return (
    <>
      {when && change === null && (
        <div class="notice warning restored" role="status">
          <span>This is the draft of {when}: it is not in the file yet.</span>
          <span class="row">
            <NeedsServer>
              <Button label="Discard" class="small" onClick={() => void file.attempt(() => file.discard())} />
            </NeedsServer>
            <Button label="Close" class="small" onClick={() => (file.restoredMs.value = null)} />
          </span>
        </div>
      )}
      {change === "gone" && <Notice kind="warning" text={`${file.name} is no longer on disk: a save writes it.`} />}
      {change === "changed" && (
        <Notice kind="warning" text={elsewhere} action={{ label: "Decide", act: () => file.compare() }} />
      )}
      {file.localOnly.value && <Notice kind="warning" text={file.localOnly.value} />}
    </>
  );
}
