// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { type LocalDrafts, NO_ROOM } from "../../src/state/drafts";
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
  name: string;
  open: (disk: Disk, more?: Answers, drafts?: LocalDrafts) => Promise<OpenFile>;
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
  name: "a.adirf",
  open: openRules,
  text: rates,
  type: (file, size) => (file as Rules).type(rates(size)),
  shown: (file) => file.content.value,
};
const TABLE: Kind = {
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

describe.each([RULES, TABLE])("the open file $name", ({ name, open, text, type, shown }) => {
  const GONE = () => {
    throw new TypeError("Failed to fetch");
  };

  /** A file that said 10 and that somebody, who is gone, changed to 11. */
  async function leftDraft(): Promise<Disk> {
    const disk: Disk = { text: text(10) };
    type(await open(disk), 11);
    await vi.runAllTimersAsync();
    return disk;
  }

  /** What a browser keeps of 11 that was typed while the server was gone. */
  async function leftHere(disk: Disk) {
    const kept = storage();
    type(await open(disk, { "PUT /api/draft": GONE }, draftsIn(kept)), 11);
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

  test("is on the server as a draft within a second of each change, and the file is as it was", async () => {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    for (let size = 11; size < 40; size++) {
      type(file, size);
      await vi.advanceTimersByTimeAsync(100);
    }
    const atOnce = disk.draft?.content;
    await vi.advanceTimersByTimeAsync(900);
    expect([atOnce === undefined, file.isKept, file.isSaved.value, disk.text]).toEqual([false, true, false, text(10)]);
  });

  test("is opened with its draft by anybody, and a save puts an end to that", async () => {
    const disk = await leftDraft();
    const file = await open(disk);
    expect([shown(file), file.isSaved.value, file.restoredMs.value === null]).toEqual([text(11), false, false]);
    await file.save();
    await vi.runAllTimersAsync();
    expect([disk.text, disk.draft, file.restoredMs.value]).toEqual([text(11), null, null]);
  });

  test("has no draft any more once undo brings back what the file says", async () => {
    const disk = await leftDraft();
    const file = await open(disk);
    file.undo();
    await vi.runAllTimersAsync();
    expect([shown(file), disk.draft, disk.text]).toEqual([text(10), null, text(10)]);
  });

  test("is not sent again where nothing changed", async () => {
    const disk = await leftDraft();
    const { id } = disk.draft ?? {};
    await open(disk);
    await vi.runAllTimersAsync();
    expect(disk.draft?.id).toBe(id);
  });

  test("comes back over a file that somebody else wrote since, and a save writes over that only once it is asked", async () => {
    const disk = await leftDraft();
    disk.text = text(7);
    const file = await open(disk);
    expect([shown(file), file.conflict.value?.isSave, disk.text]).toEqual([text(11), false, text(7)]);
    await file.keepMine();
    expect([file.conflict.value, disk.text, shown(file)]).toEqual([null, text(7), text(11)]);
    await file.save();
    expect([file.conflict.value, disk.text]).toEqual([null, text(11)]);
  });

  test("comes back as it is on disk where its draft cannot be read", async () => {
    const draft = { id: "x", content: "{", beside: "{}", base_hash: `hash of ${text(10)}`, changed_at_ms: 1 };
    const file = await open({ text: text(10), draft });
    const isRead = name.endsWith(".adirf");
    expect([shown(file), file.isSaved.value]).toEqual(isRead ? ["{", false] : [text(10), true]);
  });

  test("is kept by the browser while the server is gone, and by the server once that is back", async () => {
    const disk: Disk = { text: text(10) };
    const kept = await leftHere(disk);
    expect([disk.draft, kept.length]).toEqual([undefined, 1]);
    const file = await open(disk, {}, draftsIn(kept));
    expect([shown(file), file.conflict.value, file.restoredMs.value === null]).toEqual([text(11), null, false]);
    await vi.runAllTimersAsync();
    expect([disk.draft === null, file.isKept, kept.length]).toEqual([false, true, 0]);
  });

  test("is kept by the browser where the server has no room, which is said until it has", async () => {
    const disk: Disk = { text: text(10) };
    const kept = storage();
    let isFull = true;
    const put = fileAnswers(name, disk)["PUT /api/draft"];
    const file = await open(
      disk,
      { "PUT /api/draft": (asked) => (isFull ? refused(422) : put?.(asked)) },
      draftsIn(kept),
    );
    type(file, 11);
    await vi.runAllTimersAsync();
    expect([file.localOnly.value, kept.length]).toEqual(["The draft is in this browser only. Refused with 422", 1]);
    isFull = false;
    await file.lookAtDisk();
    expect([file.localOnly.value, kept.length, file.isKept]).toEqual(["", 0, true]);
  });

  test("says that it would be lost where neither has room", async () => {
    const setItem = () => {
      throw new Error("QuotaExceededError");
    };
    const full = { length: 0, key: () => null, getItem: () => null, removeItem: () => undefined, setItem };
    const file = await open({ text: text(10) }, { "PUT /api/draft": GONE }, draftsIn(full));
    type(file, 11);
    await vi.runAllTimersAsync();
    expect(file.localOnly.value).toBe(NO_ROOM);
  });

  test("is kept by the browser alone where somebody may only watch", async () => {
    const disk: Disk = { text: text(10) };
    const kept = storage();
    const file = await open(
      disk,
      {},
      draftsIn(kept, () => false),
    );
    type(file, 11);
    await vi.runAllTimersAsync();
    expect([disk.draft, kept.length, file.localOnly.value]).toEqual([undefined, 1, ""]);
  });

  test("is asked about where this browser and somebody else changed it", async () => {
    const disk: Disk = { text: text(10) };
    const kept = await leftHere(disk);
    const other = await open(disk);
    type(other, 12);
    await vi.runAllTimersAsync();
    const file = await open(disk, {}, draftsIn(kept));
    expect([shown(file), file.conflict.value?.isSave]).toEqual([text(11), false]);
    await file.keepMine();
    await other.lookAtDisk();
    expect([shown(other), other.isSaved.value, disk.discarded?.length]).toEqual([text(11), false, 1]);
  });

  test("is with its last letters after a draft whose answer got lost", async () => {
    const disk: Disk = { text: text(10) };
    const kept = storage();
    const put = fileAnswers(name, disk)["PUT /api/draft"];
    const lost: Answers = {
      "PUT /api/draft": (asked) => {
        put?.(asked);
        return GONE();
      },
    };
    const before = await open(disk, lost, draftsIn(kept));
    type(before, 11);
    await vi.runAllTimersAsync();
    type(before, 112);
    await vi.advanceTimersByTimeAsync(1);
    before.undo();
    type(before, 113);
    await vi.runAllTimersAsync();
    const after = await open(disk, {}, draftsIn(kept));
    expect([shown(after), after.conflict.value]).toEqual([text(113), null]);
  });

  test("shows what somebody else typed where nothing is unsaved here, and goes on with it without a question", async () => {
    const disk: Disk = { text: text(10) };
    const [ada, bob] = [await open(disk), await open(disk)];
    type(ada, 11);
    await vi.runAllTimersAsync();
    await bob.lookAtDisk();
    expect([shown(bob), bob.isSaved.value, disk.text]).toEqual([text(11), false, text(10)]);
    type(bob, 12);
    await vi.runAllTimersAsync();
    await ada.lookAtDisk();
    expect([shown(ada), ada.conflict.value, ada.diskChange.value]).toEqual([text(12), null, null]);
    await ada.save();
    await bob.lookAtDisk();
    expect([shown(bob), bob.isSaved.value, disk.text, disk.draft]).toEqual([text(12), true, text(12), null]);
  });

  test("of two who type at once the second is told, and no text is lost", async () => {
    const disk: Disk = { text: text(10) };
    const [ada, bob] = [await open(disk), await open(disk)];
    type(ada, 11);
    type(bob, 12);
    await vi.runAllTimersAsync();
    expect([ada.diskChange.value, bob.diskChange.value, shown(bob)]).toEqual([null, "changed", text(12)]);
    await bob.save();
    expect([bob.conflict.value?.isSave, disk.text]).toEqual([true, text(10)]);
    await bob.keepMine();
    expect([disk.text, disk.discarded?.length]).toEqual([text(12), 1]);
    await ada.lookAtDisk();
    expect([shown(ada), ada.isSaved.value]).toEqual([text(12), true]);
    ada.undo();
    expect(shown(ada)).toBe(text(11));
  });

  test("is discarded for what is on disk; undo and a version have what was typed", async () => {
    const disk = await leftDraft();
    const file = await open(disk);
    await file.discard();
    expect([shown(file), file.isSaved.value, file.restoredMs.value]).toEqual([text(10), true, null]);
    expect([disk.draft, disk.discarded?.length]).toEqual([null, 1]);
    file.undo();
    expect(shown(file)).toBe(text(11));
  });

  test("is discarded where it is not on disk any more, and undo brings it back", async () => {
    const disk = await leftDraft();
    disk.text = null;
    const file = await open(disk);
    expect([shown(file), file.conflict.value?.theirs]).toEqual([text(11), null]);
    await file.discard();
    expect([shown(file), file.isSaved.value, file.restoredMs.value, disk.draft]).toEqual(["", true, null, null]);
    expect(file.message.value).toBe(`${name} is not on disk`);
    file.undo();
    expect(shown(file)).toBe(text(11));
  });

  test("is compared with what is on disk before a save", async () => {
    const { file } = await contested(text(7));
    await file.compare();
    expect(
      [file.conflict.value?.mine, file.conflict.value?.theirs].map((lines) => /[0-9]+/.exec(lines ?? "")?.[0]),
    ).toEqual(name.endsWith(".adirf") ? ["11", "7"] : ["100", "100"]);
    expect(file.conflict.value?.mine).not.toBe(file.conflict.value?.theirs);
  });

  test("is read again after a conflict, and undo brings back what was here", async () => {
    const { disk, file } = await contested(text(7));
    await file.save();
    expect([file.conflict.value?.isSave, disk.text, file.isSaved.value]).toEqual([true, text(7), false]);
    await file.discard();
    expect([shown(file), file.isSaved.value, file.conflict.value]).toEqual([text(7), true, null]);
    file.undo();
    await file.save();
    expect([disk.text, file.conflict.value]).toEqual([text(11), null]);
  });

  test.each([text(7), null])("is saved after a conflict with %j where somebody keeps theirs", async (theirs) => {
    const { disk, file } = await contested(theirs);
    await file.save();
    expect([file.conflict.value?.theirs === null, disk.text]).toEqual([theirs === null, theirs]);
    await file.keepMine();
    expect([disk.text, file.isSaved.value, file.conflict.value]).toEqual([text(11), true, null]);
  });

  test("is saved where somebody else saved the same", async () => {
    const { file } = await contested(text(11));
    await file.save();
    expect([file.conflict.value, file.isSaved.value]).toEqual([null, true]);
  });

  test("takes what somebody else wrote where nothing is unsaved, and undo brings back what was here", async () => {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    disk.text = text(7);
    await file.lookAtDisk();
    expect([shown(file), file.isSaved.value, file.diskChange.value]).toEqual([text(7), true, null]);
    expect(file.message.value).toContain("was changed elsewhere");
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

  test("is not saved where it is gone, kept as a draft, and saved again once it is back", async () => {
    const disk: Disk = { text: text(10) };
    const file = await open(disk);
    disk.text = null;
    await file.lookAtDisk();
    await vi.runAllTimersAsync();
    expect([file.isSaved.value, disk.draft === null, shown(file)]).toEqual([false, false, text(10)]);
    disk.text = text(10);
    await file.lookAtDisk();
    expect([file.isSaved.value, file.diskChange.value, disk.draft]).toEqual([true, null, null]);
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
    await file.keepMine();
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
    expect([file.diskChange.value, file.conflict.value?.theirs === null]).toEqual([null, false]);
  });
});
