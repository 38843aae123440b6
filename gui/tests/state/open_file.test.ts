// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import type { DraftStorage, Drafts } from "../../src/state/drafts";
import type { OpenFile } from "../../src/state/open_file";
import {
  type Answers,
  type Disk,
  draftsIn,
  fileAnswers,
  openRules,
  openTable,
  refused,
  storage,
  typeSize,
} from "./served";

interface Kind {
  kind: "rules" | "profile";
  name: string;
  open: (disk: Disk, more?: Answers, drafts?: Drafts) => Promise<OpenFile>;
  /** The text of a file that says this much. */
  text: (size: number) => string;
  /** Changes what is open, so that a save writes the text of this size. */
  type: (file: OpenFile, size: number) => void;
  /** The text of what is open. */
  shown: (file: OpenFile) => string;
}
type Rules = Awaited<ReturnType<typeof openRules>>;
type Table = Awaited<ReturnType<typeof openTable>>;

const rates = (size: number) => `begin\n    SetFrequency /odom ${size}\nend\n`;
const sizes = (size: number | null) => JSON.stringify([{ topic: "/odom", message_kb: size }]);
const RULES: Kind = {
  kind: "rules",
  name: "a.adirf",
  open: openRules,
  text: rates,
  type: (file, size) => (file as Rules).type(rates(size)),
  shown: (file) => file.content.value,
};
const TABLE: Kind = {
  kind: "profile",
  name: "lte.toml",
  open: openTable,
  text: sizes,
  type: (file, size) => typeSize(file as Table, 0, String(size)),
  shown: (file) => {
    const [row] = (file as Table).rows.value;
    return row?.topic ? sizes(row.message_kb === "" ? null : Number(row.message_kb)) : "";
  },
};

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe.each([RULES, TABLE])("a file of $kind that is open", ({ kind, name, open, text, type, shown }) => {
  /** What somebody changed to 11 in a tab that is gone, of a file that said 10; and the browser that keeps it. */
  async function leftUnsaved(): Promise<DraftStorage> {
    const kept = storage();
    type(await open({ text: text(10) }, {}, draftsIn(kept)), 11);
    await vi.runAllTimersAsync();
    return kept;
  }

  /** How a server answers whose saves wait until they are let through, in their order. */
  function heldSaves(disk: Disk) {
    const held: (() => void)[] = [];
    const put = fileAnswers(name, disk)["PUT /api/file"];
    const answers: Answers = { "PUT /api/file": (asked) => new Promise((done) => held.push(() => done(put?.(asked)))) };
    const arrived = () => vi.waitUntil(() => held.length > 0);
    const release = async () => {
      await arrived();
      held.shift()?.();
    };
    return { answers, arrived, release };
  }

  /** An open file in which somebody typed 11, and of which others wrote this meanwhile. */
  async function contested(theirs: string | null) {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    type(file, 11);
    disk.text = theirs;
    return { disk, file };
  }

  test("is saved until it is changed, and again once undo brings back what the file says", async () => {
    const file = await open({ text: text(10) });
    expect([shown(file), file.isSaved.value, file.history.canUndo.value]).toEqual([text(10), true, false]);
    type(file, 11);
    expect([shown(file), file.isSaved.value]).toEqual([text(11), false]);
    file.undo();
    expect([shown(file), file.isSaved.value]).toEqual([text(10), true]);
    file.redo();
    expect([shown(file), file.isSaved.value]).toEqual([text(11), false]);
  });

  test("is saved by a save, after which undo leads to what is not", async () => {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    type(file, 11);
    await file.save();
    expect([disk.text, file.isSaved.value, file.message.value]).toEqual([text(11), true, `Saved ${name}`]);
    file.undo();
    expect(file.isSaved.value).toBe(false);
    file.redo();
    expect([shown(file), file.isSaved.value]).toEqual([text(11), true]);
  });

  test("is not called saved where something was typed during the save", async () => {
    const disk: Disk = { text: text(10) };
    const { answers, arrived, release } = heldSaves(disk);
    const file = await open(disk, answers);
    type(file, 11);
    const saved = file.save();
    await arrived();
    type(file, 112);
    await release();
    await saved;
    expect([disk.text, shown(file), file.isSaved.value]).toEqual([text(11), text(112), false]);
  });

  test("meets no conflict with oneself where it is saved and looked at during a save", async () => {
    const disk: Disk = { text: text(10) };
    const { answers, arrived, release } = heldSaves(disk);
    const file = await open(disk, answers);
    type(file, 11);
    const former = file.save();
    await arrived();
    type(file, 112);
    const latter = Promise.all([file.save(), file.lookAtDisk()]);
    await release();
    await release();
    await Promise.all([former, latter]);
    expect([file.conflict.value, file.diskChange.value]).toEqual([null, null]);
    expect([disk.text, file.isSaved.value]).toEqual([text(112), true]);
  });

  test("comes back with what was not saved, which a save puts an end to", async () => {
    const kept = await leftUnsaved();
    const disk: Disk = { text: text(10) };
    const file = await open(disk, {}, draftsIn(kept));
    expect([shown(file), file.isSaved.value, file.restored.value?.isContested]).toEqual([text(11), false, false]);
    await file.save();
    expect([disk.text, file.restored.value, kept.length]).toEqual([text(11), null, 0]);
  });

  test("comes back over what somebody else wrote since, and writes over it only where that is asked for", async () => {
    const disk: Disk = { text: text(7) };
    const file = await open(disk, {}, draftsIn(await leftUnsaved()));
    expect([shown(file), file.restored.value?.isContested]).toEqual([text(11), true]);
    await file.save();
    expect([file.conflict.value?.theirs, disk.text]).toEqual([text(7), text(7)]);
  });

  test("comes back as it is on disk where the browser keeps a draft that cannot be read", async () => {
    const kept = storage();
    draftsIn(kept).keep(kind, name, { content: "{", hash: null, changedMs: 1 });
    const file = await open({ text: text(10) }, {}, draftsIn(kept));
    expect([shown(file), file.isSaved.value, file.restored.value, kept.length]).toEqual([text(10), true, null, 0]);
  });

  test("says that another tab has unsaved changes of it", async () => {
    const kept = await leftUnsaved();
    const file = await open({ text: text(10) }, {}, draftsIn(kept, ["tab"], "another"));
    expect([shown(file), file.message.value]).toEqual([text(10), `Another tab has unsaved changes of ${name}`]);
  });

  test("is dropped for what is on disk, and undo brings it back", async () => {
    const file = await open({ text: text(7) }, {}, draftsIn(await leftUnsaved()));
    expect(file.restored.value?.isContested).toBe(true);
    await file.dropRestored();
    expect([shown(file), file.isSaved.value, file.restored.value]).toEqual([text(7), true, null]);
    file.undo();
    expect(shown(file)).toBe(text(11));
  });

  test("is dropped where it is not on disk any more, and undo brings it back", async () => {
    const kept = await leftUnsaved();
    const file = await open({ text: null }, {}, draftsIn(kept));
    expect([shown(file), file.restored.value === null]).toEqual([text(11), false]);
    await file.dropRestored();
    expect([shown(file), file.isSaved.value, file.restored.value, kept.length]).toEqual(["", true, null, 0]);
    expect(file.message.value).toBe(`${name} is not on disk`);
    file.undo();
    expect(shown(file)).toBe(text(11));
  });

  test("is compared with what is on disk before a save", async () => {
    const { file } = await contested(text(7));
    await file.compare();
    expect(file.conflict.value).toMatchObject({ mine: text(11), theirs: text(7) });
  });

  test("is read again after a conflict, and undo brings back what was here", async () => {
    const { disk, file } = await contested(text(7));
    await file.save();
    expect(file.conflict.value).toMatchObject({ mine: text(11), theirs: text(7) });
    expect([disk.text, file.isSaved.value]).toEqual([text(7), false]);
    await file.readAgain();
    expect([shown(file), file.isSaved.value, file.conflict.value]).toEqual([text(7), true, null]);
    file.undo();
    await file.save();
    expect([disk.text, file.conflict.value]).toEqual([text(11), null]);
  });

  test.each([text(7), null])("is saved anyway after a conflict with %j", async (theirs) => {
    const { disk, file } = await contested(theirs);
    await file.save();
    expect([file.conflict.value?.theirs, disk.text]).toEqual([theirs, theirs]);
    await file.saveAnyway();
    expect([disk.text, file.isSaved.value, file.conflict.value]).toEqual([text(11), true, null]);
  });

  test("is saved where somebody else saved the same", async () => {
    const { file } = await contested(text(11));
    await file.save();
    expect([file.conflict.value, file.isSaved.value]).toEqual([null, true]);
  });

  test("is saved as another one, and stays as it is on disk", async () => {
    const put: string[][] = [];
    const disk: Disk = { text: text(10) };
    const answers: Answers = {
      "PUT /api/file": ({ name = "", text = "" }) => {
        put.push([name, text]);
        return { hash: "new" };
      },
    };
    const file = await open(disk, answers);
    type(file, 11);
    await file.saveAs(`mine ${name}`);
    expect([put, file.isSaved.value, disk.text]).toEqual([[[`mine ${name}`, text(11)]], true, text(10)]);
  });

  test("takes what somebody else wrote where nothing is unsaved, and undo brings back what was here", async () => {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    disk.text = text(7);
    await file.lookAtDisk();
    expect([shown(file), file.isSaved.value, file.diskChange.value]).toEqual([text(7), true, null]);
    expect(file.message.value).toContain("changed on disk and is read again");
    file.undo();
    expect(shown(file)).toBe(text(10));
  });

  test("keeps what was typed while it read what somebody else wrote", async () => {
    const disk: Disk = { text: text(10) };
    const read = fileAnswers(name, disk)["GET /api/file"];
    const held: (() => void)[] = [];
    const answers: Answers = {
      "GET /api/file": (asked) =>
        disk.text === text(10) ? read?.(asked) : new Promise((done) => held.push(() => done(read?.(asked)))),
    };
    const file = await open(disk, answers);
    disk.text = text(7);
    const looked = file.lookAtDisk();
    await vi.waitUntil(() => held.length > 0);
    type(file, 11);
    held[0]?.();
    await looked;
    expect([shown(file), file.isSaved.value, file.diskChange.value]).toEqual([text(11), false, "changed"]);
  });

  test("says why it cannot be compared with what is on disk", async () => {
    const disk: Disk = { text: text(10) };
    const read = fileAnswers(name, disk)["GET /api/file"];
    const file = await open(disk, {
      "GET /api/file": (asked) => (disk.text === text(10) ? read?.(asked) : refused(422)),
    });
    type(file, 11);
    disk.text = text(7);
    await file.compare();
    expect([file.message.value, file.conflict.value]).toEqual(["Refused with 422", null]);
  });

  test.each([
    ["changed", text(7)],
    ["gone", null],
  ])("says of a file with unsaved changes that it is %s", async (change, theirs) => {
    const { file } = await contested(theirs);
    await file.lookAtDisk();
    expect([file.diskChange.value, shown(file)]).toEqual([change, text(11)]);
  });

  test("is not saved where it is gone, kept by the browser, and saved again once it is back", async () => {
    const [disk, kept] = [{ text: text(10) } as Disk, storage()];
    const file = await open(disk, {}, draftsIn(kept));
    disk.text = null;
    await file.lookAtDisk();
    await vi.runAllTimersAsync();
    expect([file.isSaved.value, draftsIn(kept).names(kind), shown(file)]).toEqual([false, [name], text(10)]);
    disk.text = text(10);
    await file.lookAtDisk();
    expect([file.isSaved.value, file.diskChange.value, draftsIn(kept).names(kind)]).toEqual([true, null, []]);
    disk.text = null;
    await file.lookAtDisk();
    disk.text = text(7);
    await file.lookAtDisk();
    expect([shown(file), file.isSaved.value, file.diskChange.value]).toEqual([text(7), true, null]);
  });

  test("is written again by a save that was told that it is gone", async () => {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    disk.text = null;
    await file.lookAtDisk();
    await file.save();
    expect([disk.text, file.conflict.value?.theirs]).toEqual([null, null]);
    await file.saveAnyway();
    expect([disk.text, file.isSaved.value, file.conflict.value, file.diskChange.value]).toEqual([
      text(10),
      true,
      null,
      null,
    ]);
  });

  test("is not looked at while a conflict is to be decided", async () => {
    const { disk, file } = await contested(text(7));
    await file.save();
    disk.text = null;
    await file.lookAtDisk();
    expect([file.diskChange.value, file.conflict.value?.theirs]).toEqual([null, text(7)]);
  });
});
