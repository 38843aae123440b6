// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, effect, type ReadonlySignal, signal } from "@preact/signals";
import { type Api, ApiError, refusal } from "../api/client";
import type { DraftRequest, FileDraft, Unsaved } from "../api/types";
import { type LocalDraft, type LocalDrafts, NO_ROOM } from "./drafts";
import { History } from "./history";

/** A draft is sent no more often than this: a long file takes longer than a letter. */
const KEEP_AFTER_MS = 400;
/** So many drafts that were sent and not answered are known: the server may have any of them. */
const MOST_IDS = 20;
const CONFLICT = 409;

/**
 * A file that is open: what is in it here, what of it is saved, and what happens to it elsewhere meanwhile.
 *
 * What is not saved is its draft on the server, and in this browser until the server has it. What a person asks for
 * fails with an ApiError and then changes nothing.
 */
export abstract class OpenFile {
  readonly message = signal("");
  /** Asked while what is here and what the server has are two changes of one file. */
  readonly conflict = signal<Conflict | null>(null);
  /** When the draft that the file was opened with was changed, until it is saved or discarded. */
  readonly restoredMs = signal<number | null>(null);
  /** What happened to the file elsewhere since it was read or kept here. */
  readonly diskChange = signal<DiskChange | null>(null);
  /** Why what is not saved is in this browser only; empty where it is on the server. */
  readonly localOnly = signal("");
  readonly history = new History();
  readonly isOpen = signal(false);
  /** What is here of the file as it was read or saved last; the hash is null where there was none. */
  protected readonly saved = signal<{ content: string; hash: string | null }>({ content: "", hash: null });
  readonly savedContent = computed(() => this.saved.value.content);
  readonly isContentSaved = computed(
    () => this.content.value === this.savedContent.value && this.diskChange.value !== "gone",
  );
  /** Whether the file holds the whole. */
  readonly isInFile: ReadonlySignal<boolean> = this.isContentSaved;
  /** Whether the file holds all that the page shows. */
  readonly isSaved: ReadonlySignal<boolean> = this.isInFile;
  protected queue: Promise<void> = Promise.resolve();
  /** The draft that the server has, as JSON, and what it may be called there. */
  private kept = NO_DRAFT;
  private knownIds: readonly string[] = [];

  /** What undo goes through: the text, or all that it is made of. */
  abstract readonly content: ReadonlySignal<string>;
  /** What a draft keeps beside that. */
  abstract readonly beside: ReadonlySignal<string>;
  protected abstract setContent(content: string): void;
  /** Asks the server what it says of the content of now. */
  abstract check(): Promise<void>;
  /** The content of a draft; null where it cannot be read. */
  protected abstract contentOfDraft(content: string): string | null;
  /** Takes what a draft keeps beside the content; null for what is saved. */
  protected abstract setBeside(beside: string | null): void;
  /** A content as lines that somebody can compare. */
  protected abstract linesOf(content: string): string;

  constructor(
    readonly api: Api,
    readonly name: string,
    private readonly drafts: LocalDrafts,
  ) {}

  /** The content that a text of the file is; null for a file that is not there. */
  protected async contentOf(text: string | null): Promise<string> {
    return text ?? "";
  }

  /** The text to save. */
  protected async written(): Promise<string> {
    return this.content.value;
  }

  /** Reads the file, where `isThere`, and what was not saved of it. */
  async open(isThere = true): Promise<void> {
    if (this.isOpen.value) return;
    const [theirs] = await Promise.all([this.elsewhere(isThere), this.readBeside()]);
    const local = this.drafts.takeOver(this.name);
    // What was not saved of a file that is gone can still be saved.
    if (isThere && theirs.hash === null && (theirs.draft ?? local) === null) await this.api.read(this.name);
    batch(() => {
      this.setContent(theirs.content);
      this.restore(theirs, local);
      this.isOpen.value = true;
    });
    this.keepDrafts();
  }

  /** Goes on with what was not saved; what somebody else changed since is asked about. */
  private restore(theirs: Elsewhere, local: LocalDraft | null): void {
    const { draft, hash } = theirs;
    const mine = local ?? draft;
    const content = mine && this.contentOfDraft(mine.content);
    this.knownIds = local?.knownIds ?? (draft === null ? [] : [draft.id]);
    this.saved.value = { content: theirs.content, hash };
    if (mine === null || content === null) return;
    this.remember();
    this.setContent(content);
    this.setBeside(mine.beside);
    this.restoredMs.value = local?.changedMs ?? draft?.changed_at_ms ?? null;
    const isOlder = mine.base_hash !== hash && content !== theirs.content;
    if (isOlder || (this.isOthers(draft) && draft?.content !== mine.content)) {
      this.saved.value = { content: theirs.content, hash: mine.base_hash };
      this.askAbout(theirs, false);
    } else this.adopt(draft, local === null);
  }

  /** Notes which draft the server has, and whether that is what is here. */
  private adopt(draft: FileDraft | null, isHere: boolean): void {
    if (this.isOthers(draft) && draft !== null) this.knownIds = [...this.knownIds, draft.id];
    // One that says what the file says is dropped.
    this.kept = draft === null ? NO_DRAFT : isHere && !this.isInFile.value ? this.packed() : "";
  }

  /** Whether the server has a draft that is not of this page. */
  private isOthers(draft: FileDraft | null): boolean {
    return draft !== null && !this.knownIds.includes(draft.id);
  }

  /** What is not saved; null while the file holds all. */
  private unsaved(): Unsaved | null {
    if (this.isInFile.value) return null;
    return { content: this.content.value, beside: this.beside.value, base_hash: this.saved.value.hash };
  }

  private packed(): string {
    return JSON.stringify(this.unsaved());
  }

  /** Whether the server has all that is not saved here. */
  get isKept(): boolean {
    return this.packed() === this.kept;
  }

  /** Keeps what is not saved, a moment after it changed, and in this browser when the page is left. */
  private keepDrafts(): void {
    let isDue = false;
    effect(() => {
      if (this.unsaved() === null) this.restoredMs.value = null;
      if (isDue) return;
      isDue = true;
      setTimeout(() => {
        isDue = false;
        this.keepHere();
        void this.queued(() => this.keepThere());
      }, KEEP_AFTER_MS);
    });
    addEventListener("pagehide", () => this.keepHere());
  }

  private keepHere(): void {
    const draft = this.unsaved();
    if (draft === null || this.isKept) this.drafts.drop(this.name);
    else this.drafts.keep(this.name, { ...draft, knownIds: this.knownIds, changedMs: Date.now() });
  }

  /** Brings the draft to the server; until that has it, it is in this browser. */
  private async keepThere(discarded: string | null = null): Promise<void> {
    const draft = this.unsaved();
    const packed = JSON.stringify(draft);
    // While it is not decided what to do with another change, nothing takes its place.
    if (packed === this.kept || this.conflict.value !== null || this.diskChange.value === "changed") return;
    const id = this.drafts.newId();
    const known_ids = [...this.knownIds];
    this.localOnly.value = "";
    // A server that is gone, and that this page may only watch, is told of on every page.
    if (this.drafts.canSend()) {
      this.knownIds = [...known_ids, id].slice(-MOST_IDS);
      try {
        await this.tellDraft({ id, known_ids, draft, discarded });
        this.knownIds = draft === null ? [] : [id];
        this.kept = packed;
      } catch (error) {
        if (!(error instanceof ApiError)) throw error;
        if (error.status === CONFLICT) this.diskChange.value = "changed";
        else if (error.status !== 0) this.localOnly.value = `The draft is in this browser only. ${error.message}`;
      }
    }
    this.keepHere();
    if (!this.isKept && !this.drafts.hasRoom) this.localOnly.value = NO_ROOM;
  }

  private tellDraft(asked: Omit<DraftRequest, "name" | "root_hash">): Promise<unknown> {
    return this.api.ask("PUT /api/draft", { name: this.name, root_hash: this.drafts.project, ...asked });
  }

  /** Remembers what is there before a change; `typedMs` is the time of a key stroke. */
  protected remember(typedMs: number | null = null): void {
    this.history.push(this.content.value, typedMs);
  }

  /** Puts another content in its place, as one step of undo. */
  protected async replace(content: string): Promise<void> {
    this.remember();
    this.setContent(content);
    await this.check();
  }

  /** Puts another content in the place of what is here; what is not saved becomes a version. */
  replaceUnsaved(content: string): Promise<void> {
    return this.queued(async () => {
      const discarded = this.content.value;
      if (!this.isContentSaved.value && this.drafts.canSend())
        await this.tellDraft({ id: "", known_ids: [], draft: null, discarded });
      await this.replace(content);
    });
  }

  undo(): void {
    this.goTo(this.history.undo(this.content.value));
  }

  redo(): void {
    this.goTo(this.history.redo(this.content.value));
  }

  private goTo(content: string | null): void {
    if (content === null) return;
    this.setContent(content);
    void this.check();
  }

  /** Saves it where nobody else changed the file. */
  save(): Promise<void> {
    return this.queued(() => this.saveNow());
  }

  private async saveNow(): Promise<void> {
    const content = this.content.value;
    const text = await this.written();
    const { hash: baseHash } = this.saved.value;
    const done = await this.savedOr409(text, baseHash);
    if (done === null) return;
    batch(() => {
      this.diskChange.value = null;
      [this.kept, this.knownIds] = [NO_DRAFT, []];
      // What was typed meanwhile is not in the file.
      this.saved.value = { content: this.asSaved(content, text), hash: done.hash };
    });
    this.keepHere();
    await this.saveBeside(baseHash === null);
    if (done.note) this.message.value = `Saved ${this.name}, but no version is kept of it: ${done.note}`;
    else this.message.value = `Saved ${this.name}${this.lackWords()}`;
  }

  /** Saves a text; null where somebody else changed the file, which is asked about. */
  private async savedOr409(text: string, baseHash: string | null): Promise<{ hash: string; note?: string } | null> {
    try {
      return await this.api.save(this.name, text, baseHash, this.knownIds);
    } catch (error) {
      if (!isStatus(error, CONFLICT)) throw error;
    }
    const theirs = await this.elsewhere();
    const { draft, hash } = theirs;
    // The same text, as after a save whose answer got lost, is saved.
    if (theirs.text === text && hash !== null && !this.isOthers(draft)) return { hash };
    this.askAbout(theirs, true);
    return null;
  }

  /** The content that was saved as this text, as it is once it is on disk. */
  protected asSaved(content: string, _text: string): string {
    return content;
  }

  /** Reads what belongs to the file and is kept beside it. */
  protected async readBeside(): Promise<void> {}

  /** Saves that beside the file, which may have been none before. */
  protected async saveBeside(_isNew: boolean): Promise<void> {}

  /** What a saved file lacks, in words. */
  protected lackWords(): string {
    return "";
  }

  /** What the server has of the file now; one that was never there is not read. */
  private async elsewhere(isThere = true): Promise<Elsewhere> {
    const read = isThere ? readIfThere(this.api, this.name) : null;
    const [onDisk, { draft }] = await Promise.all([read, this.api.draft(this.name)]);
    const text = onDisk?.text ?? null;
    return { text, hash: onDisk?.hash ?? null, content: await this.contentOf(text), draft };
  }

  private askAbout(theirs: Elsewhere, isSave: boolean): void {
    const other = this.isOthers(theirs.draft) ? theirs.draft?.content : undefined;
    const isGone = other === undefined && theirs.hash === null;
    const shown = isGone ? null : this.linesOf(other ?? theirs.content);
    this.conflict.value = { mine: this.linesOf(this.content.value), theirs: shown, elsewhere: theirs, isSave };
  }

  /** Asks what to do with what is on the server now and what is here; a refusal is said. */
  async compare(): Promise<void> {
    await this.attempt(async () => this.askAbout(await this.elsewhere(), false));
  }

  /** Goes on with what is here, and saves it where that was asked for; of another draft a version is kept. */
  keepMine(): Promise<void> {
    return this.queued(async () => {
      const { conflict } = this;
      if (conflict.value === null) return;
      const { elsewhere, isSave } = conflict.value;
      const { content, hash, draft } = elsewhere;
      batch(() => {
        conflict.value = this.diskChange.value = null;
        this.saved.value = { content, hash };
      });
      const discarded = this.isOthers(draft) ? draft?.content : null;
      this.adopt(draft, false);
      await this.keepThere(discarded);
      if (isSave) await this.saveNow();
    });
  }

  /** Goes back to what the server has without the draft of this page; undo and the versions have what was here. */
  discard(): Promise<void> {
    return this.queued(async () => {
      const asked = { id: "", known_ids: [...this.knownIds], draft: null, discarded: this.content.value };
      // Who may only watch has none there.
      if (this.drafts.canSend()) await this.tellDraft(asked);
      const theirs = await this.elsewhere();
      const isThere = theirs.hash !== null || theirs.draft !== null;
      await this.take(theirs, isThere ? `Read ${this.name} again` : `${this.name} is not on disk`);
    });
  }

  /** Looks whether somebody else changed the file; where the server has all that is here, that is taken. */
  lookAtDisk(): Promise<void> {
    return this.queued(async () => {
      if (this.conflict.value !== null) return;
      const [{ hash }, { draft }] = await Promise.all([this.api.fileState(this.name), this.api.draft(this.name)]);
      const known = this.saved.value.hash;
      const wasGone = this.diskChange.value === "gone";
      const isOthers = draft === null ? this.kept !== NO_DRAFT : this.isOthers(draft);
      const isGone = hash === null && known !== null && !this.isOthers(draft);
      this.diskChange.value = isGone ? "gone" : hash !== known || isOthers ? "changed" : null;
      // A draft of an older file is somebody's who has to decide; what a file said that was gone is nobody's.
      const isUntouched = wasGone && this.content.value === this.savedContent.value;
      const isWhole = draft === null || (isOthers && draft.base_hash === hash);
      if (this.diskChange.value === "changed") {
        const theirs = await this.elsewhere();
        const { content, draft: theirDraft } = theirs;
        // What was typed meanwhile is not replaced by what nobody asked for: it is told that the two differ.
        if (isUntouched ? this.isSettled : isWhole && this.isKept && this.isSettled)
          return this.take(theirs, `${this.name} was changed elsewhere. Undo brings back what was here`);
        if (content === this.content.value && !this.isOthers(theirDraft)) {
          this.diskChange.value = null;
          this.saved.value = { content, hash: theirs.hash };
        }
      }
      await this.keepThere();
    });
  }

  /** Whether the content says all that the page shows. */
  protected get isSettled(): boolean {
    return true;
  }

  /** Shows what somebody else has; what this page has there is dropped. */
  private async take(theirs: Elsewhere, message: string): Promise<void> {
    const draft = this.isOthers(theirs.draft) ? theirs.draft : null;
    const drafted = draft && this.contentOfDraft(draft.content);
    this.message.value = message;
    await batch(() => {
      this.conflict.value = this.diskChange.value = null;
      this.saved.value = { content: theirs.content, hash: theirs.hash };
      this.setBeside(draft?.beside ?? null);
      const done = this.replace(drafted ?? theirs.content);
      this.adopt(theirs.draft, drafted !== null);
      return done;
    });
    this.keepHere();
  }

  /** Does this once all that was asked for before is done; a save makes the hash that the next one needs. */
  protected async queued(work: () => Promise<void>): Promise<void> {
    const done = this.queue.then(work);
    // A failure reaches the caller, and does not keep later work from its turn.
    this.queue = done.catch(() => undefined);
    await done;
  }

  /** Does work and returns what comes of it; null where it was refused, which `message` says. */
  async attempt<T>(work: () => Promise<T>): Promise<T | null> {
    try {
      return await work();
    } catch (error) {
      this.message.value = refusal(error);
      return null;
    }
  }
}

/** The draft of what is saved, as JSON. */
const NO_DRAFT = "null";

/** What the server has of a file: what is on disk, null where nothing is, and the draft of it. */
interface Elsewhere {
  text: string | null;
  hash: string | null;
  /** The content that the text is. */
  content: string;
  draft: FileDraft | null;
}

/** What is here and what the server has, as lines; `theirs` is null where the file is gone. */
export interface Conflict {
  mine: string;
  theirs: string | null;
  elsewhere: Elsewhere;
  /** Whether a save asked. */
  isSave: boolean;
}

interface OnDisk {
  text: string;
  hash: string;
}

export type DiskChange = "changed" | "gone";

/** What happened to a file that had this hash. */
export async function diskChangeOf(api: Api, name: string, hash: string | null): Promise<DiskChange | null> {
  const now = (await api.fileState(name)).hash;
  if (hash === now) return null;
  return now === null ? "gone" : "changed";
}

/** Whether the server answered with this status. */
export function isStatus(error: unknown, status: number): boolean {
  return error instanceof ApiError && error.status === status;
}

/** What is on disk under a name; null where nothing is. */
async function readIfThere(api: Api, name: string): Promise<OnDisk | null> {
  try {
    return await api.read(name);
  } catch (error) {
    if (!isStatus(error, 404)) throw error;
    return null;
  }
}
