// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import type { IncidentsAnswer } from "../api/types";
import { FormDialog } from "../ui/dialog";
import { Problem } from "../ui/notice";
import { counted, moment, NS_PER_MS, sizeWords } from "../ui/numbers";

interface DeleteDialogProps {
  api: Api;
  name: string;
  size_bytes: number;
  /** What is deleted: its title, when it was and its messages; null where it cannot be read. */
  lost: { title: string; triggered_ns: number; messages: number } | null;
  onDeleted: (left: IncidentsAnswer) => void;
  onClose: () => void;
}

/** Asks before an incident is deleted, and says what is lost. */
export function DeleteDialog({ api, name, size_bytes, lost, onDeleted, onClose }: DeleteDialogProps) {
  const [problem, setProblem] = useState("");
  const size = sizeWords(size_bytes / 1000);
  const remove = async () => {
    setProblem(
      await refusalOf(async () => {
        onDeleted(await api.ask("POST /api/incident/delete", { name }));
      }),
    );
  };
  return (
    <FormDialog title="Delete this incident?" submit="Delete" onSubmit={remove} onClose={onClose}>
      {lost === null ? (
        <p>Its record cannot be read, but its messages may still be there: {size}.</p>
      ) : (
        <p>
          <strong>{lost.title}</strong> of {moment(lost.triggered_ns / NS_PER_MS)}: {counted(lost.messages, "message")},{" "}
          {size}.
        </p>
      )}
      <p class="path">{name}</p>
      <p>The folder is deleted from the disk and cannot be had back.</p>
      <Problem text={problem} />
    </FormDialog>
  );
}
