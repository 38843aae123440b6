// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { AccuracyNeeds, BoundNeed, LevelledProperty } from "../api/types";
import { ACCURACY_UNITS, keysOf, type Six, sixOf } from "../state/accuracies";
import type { DraftRow } from "../state/draft_row";
import type { ProfileEditor } from "../state/profile_editor";
import { Button } from "../ui/button";
import { WorkProgress } from "../ui/work_progress";
import type { Chart } from "./curve_plot";
import { AccuracyTables } from "./curve_tables";
import { boundsIn, moved, stopped } from "./level_axis";
import { LevelPlot } from "./level_plot";
import { needOf } from "./needs";
import { useMeasured } from "./use_measured";

/** The six accuracies of a property's levels on the messages that each needs: dragged or moved by keys. */
export function AccuracyLevels(props: {
  editor: ProfileEditor;
  api: Api;
  row: DraftRow;
  bag: string;
  property: LevelledProperty;
}) {
  const { editor, api, row, bag, property } = props;
  const { topic } = row;
  const { work, state, found } = useMeasured<AccuracyNeeds>(topic, bag);
  const [note, setNote] = useState("");
  useEffect(() => setNote(""), [row.key, property]);
  const unit = ACCURACY_UNITS[property];
  const kind = useMemo(() => boundsIn(unit), [unit]);
  const [tiersKey, needsKey] = keysOf(unit);
  const points = found?.properties.find((each) => each.property === property)?.points ?? null;
  const chart = useMemo(() => chartOf(points), [points]);
  const levels = row.accuracies[tiersKey];
  const measure = () =>
    work.start(async (run, signal) => ({
      topic,
      bag,
      found: await api.ask("POST /api/profile/accuracy", { bag, topic, run }, { signal }),
    }));
  const place = (bounds: Six, goesOn: boolean, why: string) => {
    const needs = needsOf(points, bounds);
    const lost = row.accuracies[needsKey] !== null && needs === null;
    editor.setAccuracies(row.key, { [tiersKey]: bounds, [needsKey]: needs }, goesOn);
    setNote(`${why} ${needs ? "" : unknownNeeds(points !== null, lost)}`.trim());
  };
  const move = (index: number, bound: number, goesOn: boolean) => {
    if (!levels) return;
    const next = moved(kind, levels, index, bound);
    const six = sixOf(next.levels);
    if (six) place(six, goesOn, stopped(kind, index, next));
  };
  const needed = levels && needsOf(points, levels);
  const isNew = needed && String(needed) !== String(row.accuracies[needsKey]);
  const usual = sixOf((points ?? []).map((point) => point.bound));
  return (
    <>
      <div class="row">
        {bag !== "" && state.kind !== "running" && (
          <Button label="Show what each accuracy needs" onClick={() => void measure()} />
        )}
        <WorkProgress work={work} doing={`Measuring ${topic}`} />
        {usual && !levels && (
          <Button
            label="Place six levels"
            class="primary"
            onClick={() => place(usual, false, "The levels are the measured bounds.")}
          />
        )}
        {levels && isNew && <Button label="Write what the levels need" onClick={() => place(levels, false, "")} />}
      </div>
      {found && !points && (
        <p class="quiet">
          The {property} of {topic} never changed in {bag}, so there is no curve.
        </p>
      )}
      <LevelPlot of={`${topic} ${property}`} axisLabel={`Accuracy (${unit})`} {...{ kind, levels, chart, move }} />
      {chart && (
        <p class="quiet">
          Solid: the receiver holds the last message.{chart.lines.length > 1 && " Dashed: it shows dead reckoning."}
        </p>
      )}
      <p role="status">{note || (levels ? "" : `The ${property} of ${topic} has no six levels yet.`)}</p>
      <AccuracyTables {...{ unit, levels, points }} needs_hz={row.accuracies[needsKey]} />
    </>
  );
}

/** What the bounds need, as far as that was measured; null unless it is known of all. */
function needsOf(points: readonly BoundNeed[] | null, bounds: Six): Six | null {
  return points && sixOf(bounds.map((bound) => needOf(points, bound)?.hz ?? null));
}

function unknownNeeds(isMeasured: boolean, wereKnown: boolean): string {
  if (isMeasured) return "A level is tighter than all measured bounds: what the levels need is not written.";
  return wereKnown ? "What the levels needed was removed: choose a recording and show what each accuracy needs." : "";
}

function chartOf(points: readonly BoundNeed[] | null): Chart | null {
  if (!points) return null;
  const rising = points.toReversed();
  const reckoned = rising.map((point) => point.reckoned_hz);
  const lines = [rising.map((point) => point.hold_hz)];
  return {
    at: rising.map((point) => point.bound),
    lines: reckoned.some((each) => each !== null) ? [...lines, reckoned] : lines,
    label: "Messages per s",
  };
}
