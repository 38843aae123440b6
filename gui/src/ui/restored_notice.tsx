// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { OpenFile } from "../state/open_file";
import { Button } from "./button";

const TIME = { dateStyle: "medium", timeStyle: "short" } as const;

/** Says that a draft was restored, until it is saved, dropped or closed. */
export function RestoredNotice({ file }: { file: OpenFile }) {
  const restored = file.restored.value;
  if (restored === null) return null;
  const guarded = (work: Promise<void>) => void work.catch((error: unknown) => file.tell(error));
  const when = new Date(restored.changedMs).toLocaleString("en-GB", TIME);
  return (
    <div class="notice warning restored" role="status">
      <span>
        Your unsaved changes of {when} are restored.
        {restored.isContested && " Somebody else changed the file since: a save asks what to do."}
      </span>
      <span class="row">
        {restored.isContested && <Button label="Compare" class="small" onClick={() => void file.compare()} />}
        <Button label="Drop them" class="small" onClick={() => guarded(file.dropRestored())} />
        <Button label="Close" class="small" onClick={() => (file.restored.value = null)} />
      </span>
    </div>
  );
}
