// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import { FormDialog } from "../ui/dialog";

const USUAL_S = 10;
const LONGEST_S = 60;

/** Asks for how long to listen to the robot, and then measures its topics. */
export function MeasureRobot({ measure }: { measure: (seconds: number) => Promise<void> }) {
  const [isAsking, setAsking] = useState(false);
  const [runningS, setRunning] = useState<number | null>(null);
  const run = async (seconds: number) => {
    setAsking(false);
    setRunning(seconds);
    await measure(seconds);
    setRunning(null);
  };
  return (
    <>
      <button type="button" disabled={runningS !== null} onClick={() => setAsking(true)}>
        {runningS === null ? "Measure on the robot" : `Measuring for ${runningS} s …`}
      </button>
      {isAsking && (
        <FormDialog
          title="Measure on the robot"
          submit="Measure"
          onSubmit={(form) => run(Number(form.get("seconds")))}
          onClose={() => setAsking(false)}
        >
          <label>
            Seconds
            <input name="seconds" type="number" min={1} max={LONGEST_S} step="any" value={USUAL_S} required autofocus />
          </label>
          <p class="quiet">
            Sizes and rates of all topics that the robot publishes now. It takes every message of every topic meanwhile:
            do not do this over a slow radio.
          </p>
        </FormDialog>
      )}
    </>
  );
}
