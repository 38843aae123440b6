// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { CHAPTERS } from "virtual:documentation";
import { href } from "../route";

/** All of the documentation, whole and offline: a short start, the keys, and the chapters. */
export function Documentation() {
  return (
    <>
      <Start />
      {CHAPTERS.map(({ anchor, title, html }) => (
        <section key={anchor} aria-label={title}>
          <h2 id={anchor}>{title}</h2>
          <div dangerouslySetInnerHTML={{ __html: html }} />
        </section>
      ))}
    </>
  );
}

/** The ways to the beginnings of its parts. */
export function Contents() {
  return (
    <nav class="contents" aria-label="Contents">
      <a href={href({ page: "help", name: "start" })}>Rules in five minutes</a>
      <a href={href({ page: "help", name: "keys" })}>Keys</a>
      {CHAPTERS.map(({ anchor, title }) => (
        <a key={anchor} href={href({ page: "help", name: anchor })}>
          {title}
        </a>
      ))}
    </nav>
  );
}

function Start() {
  return (
    <>
      <h2 id="start">Rules in five minutes</h2>
      <p>
        <a href={href({ page: "tour", name: "" })}>Take the tour</a>: five steps on an example. Your files stay as they
        are.
      </p>
      <ol>
        <li>
          <strong>New rate</strong> for each topic that the operator watches: how often it is sent when nothing special
          happens. These are the defaults.
        </li>
        <li>
          <strong>New rule</strong> for each situation in which that should change. IF says when; THEN says which topics
          get which rate. The + buttons add checks and rates, the − buttons take them away.
        </li>
        <li>
          Read the <strong>findings</strong> below. Each reports an error or a doubtful rule; many can be fixed with one
          click.
        </li>
        <li>
          <strong>Try on a recording</strong> shows what the rules would have done to a recording, and what the operator
          would have lost. One slider moves the robot on the map, the rules, the rates and the loss through its time.
        </li>
        <li>
          <strong>Save</strong> keeps the rules. <strong>Optimize and Download</strong> turns quality levels into rates
          that fit your link. While a robot is connected, <strong>Send to robot</strong> is in its place, and it is in
          the menu.
        </li>
      </ol>
      <h2>Zones on a map</h2>
      <p>
        <strong>Map</strong>, beside Text, shows where rules hold. Draw a rectangle or a polygon, or type a zone, and
        add it as a rule or to one; drag it, or change its numbers, to move it. Choose a map of nav2, an image or the
        path of a recording to see the floor below.
      </p>
      <h2>A running robot</h2>
      <p>
        The top of each page says whether a robot is connected. <strong>Robot</strong> shows what it relays now; while
        it follows the open rules, marks beside the blocks show which checks and rules hold there.{" "}
        <strong>Send to robot</strong> shows the differences first. The robot checks the rules and tries them for some
        seconds; without <em>Keep these rules</em> it returns to its previous rules.
      </p>
      <h2>Rates</h2>
      <p>
        A number in Hz; <code>Full</code> for every message; <code>Off</code> for none; or a quality level from{" "}
        <code>Unacceptable</code> to <code>Excessive</code>, which the optimizer turns into a number. Several rules at
        once: a higher priority wins; among equals the higher rate.
      </p>
      <h2>Checks</h2>
      <p>
        Checks below each other must all hold (AND). Put them into <em>any of</em> for OR, into <em>not</em> for the
        opposite. Properties are those of the topic's type (such as <code>pose_x</code> of odometry), any numeric field
        by its path, and for every topic <code>rate</code> (Hz), <code>bandwidth</code> (KB/s) and <code>age</code>{" "}
        (seconds since the last message).
      </p>
      <h2>Quality levels and the budget</h2>
      <p>
        A profile is a file of topic parameters: for each topic the size of one message in KB (1000 bytes) and six
        levels in Hz, and the budget, which is the total bandwidth of the link. A topic without a level is Unacceptable:
        it gets as little as that level allows. Where not everything fits, the page says what would.
      </p>
      <h2 id="keys">Keys</h2>
      <table class="keys">
        <tbody>
          <Key keys="Ctrl+Z, Ctrl+Shift+Z" does="Undo and redo, blocks and text alike" />
          <Key keys="Ctrl+S" does="Save" />
          <Key keys="F1" does="This documentation, beside what is open" />
          <Key keys="Tab" does="From part to part of the page" />
          <Key keys="Arrow keys" does="Among blocks: to the next block, field or + button" />
          <Key keys="Enter" does="Change a field; press a + or − button" />
          <Key keys="T" does="Among blocks: to the list of blocks" />
          <Key keys="Tab in a field" does="On to the next field of the rule; with Shift to the one before" />
          <Key keys="Shift+Enter" does="One more check, rate, bound, recording or default below this one" />
          <Key
            keys="↑ ↓ in a field"
            does="Choose from the list; Enter or Tab take it, Escape leaves the field as it was"
          />
          <Key keys="M" does="Move the block with the arrow keys; Enter puts it down" />
          <Key keys="Delete" does="Delete the block" />
          <Key keys="Ctrl+Space" does="In the text: suggestions" />
          <Key keys="Ctrl+] and Ctrl+[" does="In the text: indent the line more and less" />
        </tbody>
      </table>
    </>
  );
}

function Key({ keys, does }: { keys: string; does: string }) {
  return (
    <tr>
      <th scope="row">
        <kbd>{keys}</kbd>
      </th>
      <td>{does}</td>
    </tr>
  );
}
