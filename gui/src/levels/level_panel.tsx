// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from "preact/hooks";
import { refusal } from "../api/client";
import type { AccuracyNeeds, BoundNeed, Curve, LevelledProperty } from "../api/types";
import { BagWork } from "../state/bag_work";
import type { ProfileEditor } from "../state/profile_editor";
import { ACCURACY_UNITS, type DraftRow, isNumber, keysOf, type Six, sixOf, toNumber } from "../state/topic_rows";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { useAnswer } from "../ui/later";
import { WorkProgress } from "../ui/notice";
import { AccuracyTables, CurveTable, needOf } from "./curve_tables";
import { boundsIn, moved, RATES, stopped } from "./level_axis";
import { type Chart, LevelPlot } from "./level_plot";
import { RateDots } from "./rate_dots";

const RATES_OF = "Rates";
const PROPERTIES = Object.keys(ACCURACY_UNITS) as LevelledProperty[];
const accuracyOf = (property: LevelledProperty) => `Accuracy of ${property}`;

/** The six levels of one topic: of its rate, or of the accuracy of a property. */
export function LevelPanel({ editor, bags }: { editor: ProfileEditor; bags: string[] }) {
  const rows = editor.rows.value.filter((row) => row.topic.trim() !== "");
  const [topic, setTopic] = useState("");
  const [bag, setBag] = useState("");
  const [levelsOf, setLevelsOf] = useState(RATES_OF);
  const known = useKnown(editor, rows);
  const row = rows.find((each) => each.topic === topic) ?? rows[0];
  if (!row) return null;
  const properties = PROPERTIES.filter(
    (each) => known.get(row.topic)?.has(each) || row.accuracies[keysOf(ACCURACY_UNITS[each])[0]] !== null,
  );
  const property = properties.find((each) => accuracyOf(each) === levelsOf);
  return (
    <section class="levels" aria-label="Quality levels on the curve">
      <h2>Quality levels of a topic</h2>
      <p class="quiet">
        Drag the lines, or move them with the arrow keys. The table follows. A recording shows what each rate would
        lose, and what each accuracy would need.
      </p>
      <div class="row">
        <Choice label="Topic" value={row.topic} choices={rows.map((each) => each.topic)} choose={setTopic} />
        {properties.length > 0 && (
          <Choice
            label="Levels of"
            value={property ? accuracyOf(property) : RATES_OF}
            choices={[RATES_OF, ...properties.map(accuracyOf)]}
            choose={setLevelsOf}
          />
        )}
        {bags.length > 0 && <Choice label="Recording" value={bag} choices={[["", "none"], ...bags]} choose={setBag} />}
      </div>
      {property ? <AccuracyLevels {...{ editor, row, bag, property }} /> : <RateLevels {...{ editor, row, bag }} />}
    </section>
  );
}

/** What the server knows to be in messages of each topic of the table. */
function useKnown(editor: ProfileEditor, rows: readonly DraftRow[]): ReadonlyMap<string, Set<string>> {
  const types = rows.map((row) => row.type).join(" ");
  const { answer } = useAnswer(
    () => editor.api.ask("POST /api/vocabulary", { text: "", profile_text: editor.typesText }),
    [types, editor.isSaved.value],
  );
  // Without an answer the levels of rates are all there is.
  return useMemo(
    () => new Map(answer?.topics.map(({ topic, bounds }) => [topic, new Set(bounds.map(({ name }) => name))])),
    [answer],
  );
}

/** The six rates of a topic's levels on what each rate loses: dragged, moved by keys, or proposed. */
function RateLevels({ editor, row, bag }: { editor: ProfileEditor; row: DraftRow; bag: string }) {
  const { topic } = row;
  const { work, state, found: curve } = useMeasured<Curve>(topic, bag);
  const [note, setNote] = useState("");
  const [pointed, setPointed] = useState<number | null>(null);
  const chart = useMemo(() => errorChart(curve), [curve]);
  const levels = levelsOf(row);
  const measure = () =>
    work.start(async (run, signal) => ({
      topic,
      bag,
      found: await editor.api.ask("POST /api/profile/curve", { bag, topic, run }, { signal }),
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
        <Proposal {...{ editor, row, curve, setNote }} hasLevels={levels !== null} />
      </div>
      {curve && !chart && (
        <p class="quiet">
          No number in {topic} ever changed in {bag}, so there is no curve.
        </p>
      )}
      <LevelPlot of={topic} kind={RATES} axisLabel="Rate (Hz)" {...{ levels, chart, move }} pointed={setPointed} />
      {levels && <RateDots rate_hz={pointed ?? levels[0] ?? 0} source_hz={sourceOf(row, curve)} />}
      <p role="status">{note || (levels ? "" : `${topic} has no six levels yet.`)}</p>
      {curve && chart && <CurveTable curve={curve} />}
    </>
  );
}

function errorChart(curve: Curve | null): Chart | null {
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
  row: DraftRow;
  curve: Curve | null;
  hasLevels: boolean;
  setNote: (note: string) => void;
}) {
  const { editor, row, curve, setNote } = props;
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
  const source_hz = sourceOf(row, curve);
  if (props.hasLevels || source_hz === null || !isNumber(row.source_hz)) return null;
  const guess = async () => {
    try {
      const { tiers_hz } = await editor.api.ask("POST /api/profile/levels", { source_hz });
      place(tiers_hz, "The levels are a first guess from the source's rate.");
    } catch (error) {
      setNote(refusal(error));
    }
  };
  return <Button label="Place six levels" onClick={() => void guess()} />;
}

function sourceOf(row: DraftRow, curve: Curve | null): number | null {
  return toNumber(row.source_hz) ?? curve?.source_hz ?? null;
}

/** The levels of a row; null unless all six are numbers that do not fall. */
function levelsOf(row: DraftRow): number[] | null {
  const levels = row.tiers_hz.map(toNumber);
  const isRising = levels.every((rate, index) => rate !== null && rate >= (levels[index - 1] ?? 0));
  return isRising ? levels.map((rate) => rate ?? 0) : null;
}

/** The six accuracies of a property's levels on the messages that each needs: dragged or moved by keys. */
function AccuracyLevels(props: { editor: ProfileEditor; row: DraftRow; bag: string; property: LevelledProperty }) {
  const { editor, row, bag, property } = props;
  const { topic } = row;
  const { work, state, found } = useMeasured<AccuracyNeeds>(topic, bag);
  const [note, setNote] = useState("");
  useEffect(() => setNote(""), [row.key, property]);
  const unit = ACCURACY_UNITS[property];
  const kind = useMemo(() => boundsIn(unit), [unit]);
  const [tiersKey, needsKey] = keysOf(unit);
  const points = found?.properties.find((each) => each.property === property)?.points ?? null;
  const chart = useMemo(() => needsChart(points), [points]);
  const levels = row.accuracies[tiersKey];
  const measure = () =>
    work.start(async (run, signal) => ({
      topic,
      bag,
      found: await editor.api.ask("POST /api/profile/accuracy", { bag, topic, run }, { signal }),
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

function needsChart(points: readonly BoundNeed[] | null): Chart | null {
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

/** Work on a topic of a recording, and what it found while both are still the chosen ones. */
function useMeasured<T>(topic: string, bag: string) {
  const work = useMemo(() => new BagWork<{ topic: string; bag: string; found: T }>(), []);
  useEffect(() => () => work.cancel(), []);
  const state = work.state.value;
  const isOfThese = state.kind === "done" && state.answer.topic === topic && state.answer.bag === bag;
  return { work, state, found: isOfThese ? state.answer.found : null };
}
