// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { RulePush } from "../state/rule_push";
import { FormDialog } from "../ui/dialog";

/** What would change on the robot, before anything is sent. */
export function SendDialog({ rulePush }: { rulePush: RulePush }) {
  const stage = rulePush.stage.value;
  if (stage.kind !== "asked") return null;
  const { preview, node } = stage;
  // Sending closes the dialog, too, and the stage of that must stay.
  const close = () => rulePush.stage.peek() === stage && rulePush.close();
  if (preview.same) {
    return (
      <FormDialog title={`Send to ${node}`} submit="Close" isNotice onSubmit={close} onClose={close}>
        <p>The robot already has these rules. Comments and layout of the text are not sent.</p>
      </FormDialog>
    );
  }
  return (
    <FormDialog title={`Send to ${node}`} submit="Send" onSubmit={() => rulePush.send()} onClose={close}>
      <p>This changes on the robot:</p>
      <ul class="differences" aria-label="Differences">
        {preview.differences.map((difference) => (
          <li key={difference}>{difference}</li>
        ))}
      </ul>
      <p class="quiet">
        The robot checks the rules and tries them. It returns to its previous rules unless you keep them.
      </p>
    </FormDialog>
  );
}
