// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { matching } from "../../src/ui/picker";

const TOPICS = ["/odom_filtered", "/odom", "/camera/image_raw/compressed", "/camera/image_raw", "/robot/odom", "/imu"];
const words = (text: string) =>
  matching(
    TOPICS.map((word) => ({ word })),
    text,
  ).map(({ choice }) => choice.word);

test("everything is offered in its order where nothing is typed", () => {
  expect(words("")).toEqual(TOPICS);
});

test.each([
  ["odom", ["/odom", "/odom_filtered", "/robot/odom"]],
  ["/odom", ["/odom", "/odom_filtered", "/robot/odom"]],
  ["IMU", ["/imu"]],
  ["raw", ["/camera/image_raw/compressed", "/camera/image_raw"]],
  ["image_raw", ["/camera/image_raw", "/camera/image_raw/compressed"]],
  ["lidar", []],
])("%j finds %j, the likeliest first", (text, found) => {
  expect(words(text)).toEqual(found);
});

test("a note is searched as well, behind the names", () => {
  const all = [
    { word: "yaw", note: "where the robot heads" },
    { word: "robot_speed", note: "m/s" },
  ];
  expect(matching(all, "robot").map(({ choice, isByName }) => [choice.word, isByName])).toEqual([
    ["robot_speed", true],
    ["yaw", false],
  ]);
});
