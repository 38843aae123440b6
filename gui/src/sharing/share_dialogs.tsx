// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import { useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import type { RuleEditor } from "../state/rule_editor";
import { useDroppedFile } from "../ui/files";
import { ExportDialog } from "./export_dialog";
import { ImportDialog } from "./import_dialog";

export type Sharing = "import" | "export" | null;

interface Props {
  editor: RuleEditor;
  api: Api;
  project: Project;
  /** Which of the two is asked for. */
  sharing: Signal<Sharing>;
}

/** What asks which rules to import or to export; a file dropped on the page is imported too. */
export function ShareDialogs({ sharing, ...props }: Props) {
  const [dropped, setDropped] = useState<File | null>(null);
  const close = () => {
    sharing.value = null;
    setDropped(null);
  };
  useDroppedFile((file) => {
    setDropped(file);
    sharing.value = "import";
  });
  if (sharing.value === "import") return <ImportDialog {...props} dropped={dropped} onClose={close} />;
  if (sharing.value === "export") return <ExportDialog {...props} onClose={close} />;
  return null;
}
