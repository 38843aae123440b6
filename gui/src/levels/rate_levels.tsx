// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useMemo, useState } from "preact/hooks";
import { type Api, refusal } from "../api/client";
import type { Curve } from "../api/types";
import { type DraftRow, isNumber, toNumber } from "../state/draft_row";
import type { ProfileEditor } from "../state/profile_editor";
import { Button } from "../ui/button";
import { WorkProgress } from "../ui/work_progress";
import type { Chart } from "./curve_plot";
import { CurveTable } from "./curve_tables";
import { moved, RATES, stopped } from "./level_axis";
import { LevelPlot } from "./level_plot";
import { useMeasured } from "./use_measured";

/** The six rates of a topic's levels on what each rate loses: dragged, moved by keys, or proposed. */
export function RateLevels({ editor, api, row, bag }: { editor: ProfileEditor; api: Api; row: DraftRow; bag: string }) {
  const { topic } = row;
  const { work, state, found: curve } = useMeasured<Curve>(topic, bag);
  const [note, setNote] = useState("");
  const chart = useMemo(() => chartOf(curve), [curve]);
  const levels = levelsOf(row);
  const measure = () =>
    work.start(async (run, signal) => ({
      topic,
      bag,
      found: await api.ask("POST /api/profile/curve", { bag, topic, run }, { signal }),
    }));
  const move = (index: number, rate_hz: number, goesOn: boolean) => {
    if (!levels) return;
    const next = moved(RATES, levels, index, rate_hz);
    editor.setTiers(row.key, next.levels, goesOn);
    setNote(stopped(RATES, index, next));
  };
  return (
    <>
      <div class="row">
        {bag !== "" && state.kind !== "running" && (
          <Button label="Show what each rate loses" onClick={() => void measure()} />
        )}
        <WorkProgress work={work} doing={`Measuring ${topic}`} />
        <Proposal {...{ editor, api, row, curve, setNote }} hasLevels={levels !== null} />
      </div>
      {curve && !chart && (
        <p class="quiet">
          No number in {topic} ever changed in {bag}, so there is no curve.
        </p>
      )}
      <LevelPlot of={topic} kind={RATES} axisLabel="Rate (Hz)" {...{ levels, chart, move }} />
      <p role="status">{note || (levels ? "" : `${topic} has no six levels yet.`)}</p>
      {curve && chart && <CurveTable curve={curve} />}
    </>
  );
}

function chartOf(curve: Curve | null): Chart | null {
  if (!curve || curve.points.length === 0) return null;
  return {
    at: curve.points.map((point) => point.rate_hz),
    lines: [curve.points.map((point) => point.error_percent)],
    label: "Error (% of the range)",
  };
}

/** One click to levels: where the curve bends, or, without one, shares of the source's rate. */
function Proposal(props: {
  editor: ProfileEditor;
  api: Api;
  row: DraftRow;
  curve: Curve | null;
  hasLevels: boolean;
  setNote: (note: string) => void;
}) {
  const { editor, api, row, curve, setNote } = props;
  const place = (levels: readonly number[], why: string) => {
    editor.setTiers(row.key, levels, false);
    setNote(why);
  };
  const bends = curve?.tiers_hz;
  if (bends) {
    return (
      <Button
        label="Use the proposed levels"
        class="primary"
        onClick={() => place(bends, "The levels are where the error falls to 20, 10, 5, 2, 1 and 0 % of the range.")}
      />
    );
  }
  const source_hz = toNumber(row.source_hz) ?? curve?.source_hz ?? null;
  if (props.hasLevels || source_hz === null || !isNumber(row.source_hz)) return null;
  const guess = async () => {
    try {
      place((await api.levels(source_hz)).tiers_hz, "The levels are a first guess from the source's rate.");
    } catch (error) {
      setNote(refusal(error));
    }
  };
  return <Button label="Place six levels" onClick={() => void guess()} />;
}

/** The levels of a row; null unless all six are numbers that do not fall. */
function levelsOf(row: DraftRow): number[] | null {
  const levels = row.tiers_hz.map(toNumber);
  const isRising = levels.every((rate, index) => rate !== null && rate >= (levels[index - 1] ?? 0));
  return isRising ? levels.map((rate) => rate ?? 0) : null;
}
