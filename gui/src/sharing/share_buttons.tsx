// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import type { RuleEditor } from "../state/rule_editor";
import { useDroppedFile } from "../ui/dropped_file";
import { ExportDialog } from "./export_dialog";
import { ImportDialog } from "./import_dialog";

/** Import and Export of the editor; a file dropped on the page is imported too. */
export function ShareButtons(props: { editor: RuleEditor; api: Api; project: Project }) {
  const [open, setOpen] = useState<"import" | "export" | null>(null);
  const [dropped, setDropped] = useState<File | null>(null);
  const close = () => {
    setOpen(null);
    setDropped(null);
  };
  useDroppedFile((file) => {
    setDropped(file);
    setOpen("import");
  });
  return (
    <>
      <button type="button" onClick={() => setOpen("import")}>
        Import
      </button>
      <button type="button" onClick={() => setOpen("export")}>
        Export
      </button>
      {open === "import" && <ImportDialog {...props} dropped={dropped} onClose={close} />}
      {open === "export" && <ExportDialog {...props} onClose={close} />}
    </>
  );
}
