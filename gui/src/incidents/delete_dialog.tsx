// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import type { IncidentSummary, IncidentsAnswer } from "../api/types";
import { FormDialog } from "../ui/dialog";
import { Problem } from "../ui/notice";
import { counted, sizeWords } from "../ui/numbers";
import { moment } from "../ui/times";

interface DeleteDialogProps {
  api: Api;
  /** What is deleted; what cannot be read has no summary. */
  incident: { name: string; size_kb: number; summary: IncidentSummary | null };
  onDeleted: (left: IncidentsAnswer) => void;
  onClose: () => void;
}

/** Asks before an incident is deleted, and says what is lost. */
export function DeleteDialog({ api, incident, onDeleted, onClose }: DeleteDialogProps) {
  const [problem, setProblem] = useState("");
  const { name, size_kb, summary } = incident;
  const remove = async () => {
    setProblem(
      await refusalOf(async () => {
        onDeleted(await api.ask("POST /api/incident/delete", { name }));
      }),
    );
  };
  return (
    <FormDialog title="Delete this incident?" submit="Delete" onSubmit={remove} onClose={onClose}>
      {summary === null ? (
        <p>Its record cannot be read, but its messages may still be there: {sizeWords(size_kb)}.</p>
      ) : (
        <p>
          <strong>{summary.title}</strong> of {moment(summary.triggered_ms)}: {counted(summary.messages, "message")},{" "}
          {sizeWords(size_kb)}.
        </p>
      )}
      <p class="path">{name}</p>
      <p>The folder is deleted from the disk and cannot be had back.</p>
      <Problem text={problem} />
    </FormDialog>
  );
}
