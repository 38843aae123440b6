// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** One stop of the tour: what it says, and the part of the page that it points at. */
interface TourStep {
  title: string;
  text: string;
  /** Finds that part by what it is called on the page. */
  part: string;
}

/** The tour of the editor, for people who do not program. */
export const STEPS: readonly TourStep[] = [
  {
    title: "Rules are blocks",
    text:
      "A blue block says how often one topic of the robot is sent when nothing special happens. The brown block is a " +
      "rule: IF all of its green checks hold, THEN other rates apply. Here the operator sees more while the robot is " +
      "at the loading dock. Click a white field to change it; this is an example, and nothing of it is saved.",
    part: '[aria-label="Blocks"]',
  },
  {
    title: "The same as text",
    text:
      "Blocks and text always say the same: change whichever you like, Undo covers both. Map, beside it, shows where " +
      "rules hold as rectangles that you can draw and drag.",
    part: ".side",
  },
  {
    title: "What is wrong or doubtful",
    text:
      "The findings check your rules while you work and mark the place. Here /imu has no rate of its own outside the " +
      "loading dock. Many findings are mended with one click, and Why? explains them.",
    part: '[aria-label="Results"]',
  },
  {
    title: "Try before you trust",
    text:
      "Try on a recording plays a recording of your robot and shows what the rules would have sent, and what the operator " +
      "would have lost. No robot is needed, and nothing is changed.",
    part: '[role="group"][aria-label="Try"]',
  },
  {
    title: "Send or download",
    text:
      "Optimize and Download turns words such as Desirable into rates that fit your radio link. With a robot, it is " +
      "Send to robot: that shows what would change, tries it for ten seconds, and goes back by itself unless you keep " +
      "it. The other one is in the menu. New Rule File, on the first screen, is where your own rules begin.",
    part: '[role="group"][aria-label="Send or download"]',
  },
];
