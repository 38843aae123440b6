// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { type TypedRow, tableCells, withPasted } from "../../src/state/topic_rows";

const row = (topic: string, size = ""): TypedRow => ({
  topic,
  message_kb: size,
  tiers_hz: ["", "", "", "", "", ""],
  priority: "",
  source_hz: "",
  min_hz: "",
  max_hz: "",
});
const empty = () => row("");
const shown = (rows: readonly TypedRow[]) => rows.map(({ topic, message_kb }) => `${topic} ${message_kb}`.trim());
const LINES = tableCells("/odom\t0,72\t1\t2\t3\t4\t5\t6\t2\t25\n/scan\t3\n");

test("titles and empty lines of a spreadsheet are no topics", () => {
  const table = "Topic\tSize (KB)\tUnacceptable\r\n/odom\t0.7\t5\r\n\t\t\r\n/scan\t3\t1\r\n";
  expect(tableCells(table)).toEqual([
    ["/odom", "0.7", "5"],
    ["/scan", "3", "1"],
  ]);
  expect(tableCells("/odom\t")).toEqual([["/odom", ""]]);
});

test("topics without numbers are no titles", () => {
  const topics = [
    ["/odom", ""],
    ["/scan", "5"],
  ];
  expect(tableCells("/odom\t\n/scan\t5\n")).toEqual(topics);
  expect(tableCells("/odom\tn/a\n/scan\t5\n")[0]).toEqual(["/odom", "n/a"]);
  expect(tableCells("odom\t\nscan\t5\n")[0]).toEqual(["odom", ""]);
});

test("text that is no table is left alone", () => {
  expect(tableCells("/odom")).toEqual([]);
  expect(tableCells("/odom 0.7\n/scan 3")).toEqual([]);
});

test("a table makes the rows that it needs in an empty one, with all cells", () => {
  const rows = withPasted([empty()], null, LINES, empty);
  expect(shown(rows)).toEqual(["/odom 0,72", "/scan 3"]);
  expect(rows[0]).toMatchObject({ tiers_hz: ["1", "2", "3", "4", "5", "6"], priority: "2", source_hz: "25" });
});

test("each line goes where its topic is, and the others stay", () => {
  const rows = [row("/imu", "1"), row("/scan", "9"), row("/tf")];
  expect(shown(withPasted(rows, null, LINES, empty))).toEqual(["/imu 1", "/scan 3", "/tf", "/odom 0,72"]);
});

test("from a cell on, rows are written over, and one that waited for a topic's numbers goes", () => {
  const rows = [row("/imu", "1"), row("/camera"), row("/tf"), row("/odom"), row("/scan", "9")];
  expect(shown(withPasted(rows, 1, LINES, empty))).toEqual(["/imu 1", "/odom 0,72", "/scan 3", "/scan 9"]);
});
