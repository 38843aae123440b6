// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from "preact/hooks";
import { type Api, ApiError } from "../api/client";
import type { Curve } from "../api/types";
import { TIERS } from "../api/types";
import { BagWork } from "../state/bag_work";
import { type DraftRow, isNumber, type ProfileEditor, toNumber } from "../state/profile_editor";
import { readable } from "../ui/numbers";
import { WorkProgress } from "../ui/work_progress";
import { CurveTable } from "./curve_table";
import { LevelPlot } from "./level_plot";
import { moved } from "./rate_axis";

interface Measured {
  topic: string;
  bag: string;
  curve: Curve;
}

/** The six levels of one topic on what each rate loses: dragged, moved by keys, or proposed. */
export function LevelPanel({ editor, api, bags }: { editor: ProfileEditor; api: Api; bags: string[] }) {
  const work = useMemo(() => new BagWork<Measured>(), []);
  useEffect(() => () => work.cancel(), []);
  const rows = editor.rows.value.filter((row) => row.topic.trim() !== "");
  const [topic, setTopic] = useState("");
  const [bag, setBag] = useState("");
  const [note, setNote] = useState("");
  const row = rows.find((each) => each.topic === topic) ?? rows[0];
  if (!row) return null;
  const state = work.state.value;
  const measured =
    state.kind === "done" && state.answer.topic === row.topic && state.answer.bag === bag ? state.answer : null;
  const curve = measured?.curve ?? null;
  const levels_hz = levelsOf(row);
  const measure = () =>
    work.start(async (run, signal) => ({ topic: row.topic, bag, curve: await api.curve(bag, row.topic, run, signal) }));
  const move = (index: number, rate_hz: number, goesOn: boolean) => {
    if (!levels_hz) return;
    const next = moved(levels_hz, index, rate_hz);
    editor.setTiers(row.key, next.levels_hz, goesOn);
    setNote(next.stoppedBy === null ? "" : stopped(index, next.stoppedBy, next.levels_hz));
  };
  return (
    <section class="levels" aria-label="Quality levels on the curve">
      <h2>Quality levels of a topic</h2>
      <p class="quiet">
        Drag the lines, or move them with the arrow keys. The table follows. A recording shows what each rate would
        lose.
      </p>
      <div class="row">
        <Choice label="Topic" value={row.topic} choices={rows.map((each) => each.topic)} choose={setTopic} />
        {bags.length > 0 && <Choice label="Recording" value={bag} none="none" choices={bags} choose={setBag} />}
        {bag !== "" && state.kind !== "running" && (
          <button type="button" onClick={() => void measure()}>
            Show what each rate loses
          </button>
        )}
        <WorkProgress work={work} doing={`Measuring ${row.topic}`} />
        <Proposal {...{ editor, api, row, curve, setNote }} hasLevels={levels_hz !== null} />
      </div>
      {curve && curve.points.length === 0 && (
        <p class="quiet">
          No number in {row.topic} ever changed in {bag}, so there is no curve.
        </p>
      )}
      <LevelPlot topic={row.topic} {...{ levels_hz, curve, move }} />
      <p role="status">{note || (levels_hz ? "" : `${row.topic} has no six levels yet.`)}</p>
      {curve && curve.points.length > 0 && <CurveTable curve={curve} />}
    </section>
  );
}

function Choice(props: {
  label: string;
  value: string;
  choices: string[];
  none?: string;
  choose: (value: string) => void;
}) {
  return (
    <label>
      {props.label}
      <select value={props.value} onChange={(event) => props.choose(event.currentTarget.value)}>
        {props.none !== undefined && <option value="">{props.none}</option>}
        {props.choices.map((each) => (
          <option key={each}>{each}</option>
        ))}
      </select>
    </label>
  );
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
      <button
        type="button"
        class="primary"
        onClick={() => place(bends, "The levels are where the error falls to 20, 10, 5, 2, 1 and 0 % of the range.")}
      >
        Use the proposed levels
      </button>
    );
  }
  const source_hz = toNumber(row.source_hz) ?? curve?.source_hz ?? null;
  if (props.hasLevels || source_hz === null || !isNumber(row.source_hz)) return null;
  const guess = async () => {
    try {
      place((await api.levels(source_hz)).tiers_hz, "The levels are a first guess from the source's rate.");
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      setNote(error.message);
    }
  };
  return (
    <button type="button" onClick={() => void guess()}>
      Place six levels
    </button>
  );
}

/** The levels of a row; null unless all six are numbers that do not fall. */
function levelsOf(row: DraftRow): number[] | null {
  const levels = row.tiers_hz.map(toNumber);
  const isRising = levels.every((rate, index) => rate !== null && rate >= (levels[index - 1] ?? 0));
  return isRising ? levels.map((rate) => rate ?? 0) : null;
}

function stopped(index: number, by: number, levels_hz: readonly number[]): string {
  const way = by < index ? "below" : "above";
  return `${TIERS[index]} stops at ${TIERS[by]} (${readable(levels_hz[by] ?? 0)} Hz): it cannot lie ${way} it.`;
}
