// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo, useState } from "preact/hooks";
import type { TryCrossing, TryFieldLoss, TryImages, TryTopicLoss } from "../api/types";
import type { Trial } from "../state/trial";
import { Choice } from "../ui/choice";
import { DataTable } from "../ui/data_table";
import { readable } from "../ui/numbers";
import { Chart } from "./chart";

const nameOf = (loss: TryFieldLoss) => `${loss.topic} ${loss.field}`;
const LEAST = 0.0001;

function shown(value: number | null | undefined): string {
  if (value === null || value === undefined) return "–";
  return value > 0 && value < LEAST ? `< ${LEAST}` : readable(value);
}

/** What the operator would lose, over all and at the time of the scrubber. */
export function LossTables({ trial }: { trial: Trial }) {
  const { fields, topics, crossings, images } = trial.answer.loss;
  const [chosen, setChosen] = useState(fields[0] ? nameOf(fields[0]) : "");
  const field = fields.find((each) => nameOf(each) === chosen);
  const crossed = crossings.filter((each) => each.crossings > 0);
  return (
    <section class="loss" aria-label="What the operator loses">
      <h3>What the operator loses</h3>
      {fields.length > 0 && (
        <Choice label="Error over time of" value={chosen} choices={fields.map(nameOf)} choose={setChosen} />
      )}
      {field && <LossChart key={chosen} {...{ trial, field }} />}
      {fields.length > 0 && <FieldTable {...{ trial, fields }} />}
      <AgeTable {...{ trial, topics }} />
      {crossed.length > 0 && <CrossingTable crossings={crossed} />}
      {images.length > 0 && <ImageTable images={images} />}
    </section>
  );
}

function FieldTable({ trial, fields }: { trial: Trial; fields: TryFieldLoss[] }) {
  const bin = trial.bin.value;
  return (
    <DataTable
      caption="Error when the last received value is held"
      heads={["Value", "Unit", "Mean (RMSE)", "Largest", "Mean (% of its range)", "Largest here"]}
      rows={fields.map((each) => [
        nameOf(each),
        each.unit,
        shown(each.hold?.rmse),
        shown(each.hold?.max),
        shown(each.hold?.relative_rmse == null ? null : 100 * each.hold.relative_rmse),
        shown(each.error_bins[bin]),
      ])}
    />
  );
}

function AgeTable({ trial, topics }: { trial: Trial; topics: TryTopicLoss[] }) {
  const bin = trial.bin.value;
  return (
    <DataTable
      caption="Age of the newest message received"
      heads={["Topic", "Mean (s)", "95 % below (s)", "Greatest (s)", "Greatest here (s)"]}
      rows={topics.map(({ topic, received: { age }, age_s_bins }) => [
        topic,
        shown(age?.mean_s),
        shown(age?.p95_s),
        shown(age?.max_s),
        shown(age_s_bins[bin]),
      ])}
    />
  );
}

function CrossingTable({ crossings }: { crossings: TryCrossing[] }) {
  return (
    <DataTable
      caption="Thresholds of your checks that were crossed"
      heads={["Check", "Crossed", "Seen in time", "Seen late", "Missed", "Latest (s)", "Wrong (s)"]}
      rows={crossings.map((each) => [
        each.check,
        String(each.crossings),
        String(each.received.in_time),
        String(each.received.late),
        String(each.received.missed),
        shown(each.received.late_max_s),
        shown(each.received.wrong_s),
      ])}
    />
  );
}

function ImageTable({ images }: { images: TryImages[] }) {
  return (
    <DataTable
      caption="Images"
      heads={["Topic", "Frames sent by the robot", "Frames received", "Longest without one (s)"]}
      rows={images.map(({ topic, sent, received }) => [
        topic,
        String(sent.frames),
        String(received.frames),
        shown(received.longest_blind_s),
      ])}
    />
  );
}

/** The error of one value over time. */
function LossChart({ trial, field }: { trial: Trial; field: TryFieldLoss }) {
  const lines = useMemo(() => ({ after: field.error_bins }), [field]);
  return (
    <Chart timeline={trial} lines={lines} label={`Error of ${field.topic} ${field.field}`}>
      <span class="quiet">Largest error in each stretch of time ({field.unit || "in its own unit"})</span>
    </Chart>
  );
}
