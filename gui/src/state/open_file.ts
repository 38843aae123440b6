// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, type ReadonlySignal, signal } from "@preact/signals";
import { type Api, ApiError, refusal } from "../api/client";
import { type Draft, type DraftKind, type Drafts, type Restored, storeDraft } from "./drafts";

/**
 * A file that is open: what is in it here, what of it is saved, and what happens to it on disk meanwhile.
 *
 * What a person asks for fails with an ApiError and then changes nothing.
 */
export abstract class OpenFile {
  readonly message = signal("");
  readonly conflict = signal<Conflict | null>(null);
  /** What was restored, until it is saved or dropped. */
  readonly restored = signal<Restored | null>(null);
  /** What happened to the file on disk since it was read or saved here. */
  readonly diskChange = signal<DiskChange | null>(null);
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

  /** What undo goes through: the text, or all that it is made of. */
  abstract readonly content: ReadonlySignal<string>;
  /** What a save writes, as a draft holds it; another object after each change. */
  abstract readonly whole: ReadonlySignal<object>;
  protected abstract setContent(content: string): void;
  /** Asks the server what it says of the content of now. */
  abstract check(): Promise<void>;
  /** Takes what a draft holds beside the content, and returns that; null where it cannot be read. */
  protected abstract unpacked(draft: string): string | null;

  constructor(
    readonly api: Api,
    readonly name: string,
    private readonly kind: DraftKind,
    private readonly drafts: Drafts,
  ) {}

  /** The content that a text of the file is; null for a file that is not there. */
  protected async contentOf(text: string | null): Promise<string> {
    return text ?? "";
  }

  /** The text to save under this name. */
  protected async written(_name: string): Promise<string> {
    return this.content.value;
  }

  /** Reads the file, where `isThere`, and what was not saved of it. */
  async open(isThere = true): Promise<void> {
    if (this.isOpen.value) return;
    const draft = await this.drafts.takeOver(this.kind, this.name);
    // What was not saved of a file that is gone can still be saved.
    const read = () => (draft ? readIfThere(this.api, this.name) : this.api.read(this.name));
    const [onDisk] = await Promise.all([isThere ? read() : null, this.readBeside()]);
    const content = await this.contentOf(onDisk?.text ?? null);
    batch(() => {
      this.saved.value = { content, hash: onDisk?.hash ?? null };
      this.setContent(content);
      if (draft !== null) this.restore(draft);
      this.isOpen.value = true;
    });
    if (this.drafts.isElsewhere(this.kind, this.name)) {
      this.message.value = `Another tab has unsaved changes of ${this.name}`;
    }
    storeDraft(this.drafts, this.kind, this);
  }

  /** Goes on with what was not saved; where the file is another one by now, a save meets that. */
  private restore({ content, hash, changedMs }: Draft): void {
    const mine = this.unpacked(content);
    if (mine === null) return;
    this.remember();
    this.setContent(mine);
    this.restored.value = { changedMs, isContested: hash !== this.saved.value.hash };
    this.saved.value = { ...this.saved.value, hash };
  }

  draft(): (() => Draft) | null {
    const [whole, { hash }, changedMs] = [this.whole.value, this.saved.value, Date.now()];
    return this.isInFile.value ? null : () => ({ content: JSON.stringify(whole), hash, changedMs });
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
    return this.queued(() => this.saveOver(this.saved.value.hash));
  }

  /** Replaces what the conflict is with. */
  saveAnyway(): Promise<void> {
    return this.queued(async () => {
      const hash = this.conflict.value?.hash;
      if (hash !== undefined) await this.saveOver(hash);
    });
  }

  /** Saves what is here as a new file, and leaves this one as it is on disk. */
  async saveAs(name: string): Promise<void> {
    const content = this.content.value;
    await this.api.save(name, await this.written(name), null);
    await this.saveBeside(name, true);
    this.conflict.value = this.diskChange.value = null;
    this.saved.value = { ...this.saved.value, content };
  }

  private async saveOver(baseHash: string | null): Promise<void> {
    const content = this.content.value;
    const text = await this.written(this.name);
    const done = await saveOver(this.api, this.name, text, baseHash);
    this.conflict.value = "mine" in done ? done : null;
    if ("mine" in done) return;
    batch(() => {
      this.diskChange.value = null;
      // What was typed meanwhile is not in the file.
      this.saved.value = { content: this.asSaved(content, text), hash: done.hash };
    });
    await this.saveBeside(this.name, baseHash === null);
    if (done.note) this.message.value = `Saved ${this.name}, but no version is kept of it: ${done.note}`;
    else this.message.value = `Saved ${this.name}${this.lackWords()}`;
  }

  /** The content that was saved as this text, as it is once it is on disk. */
  protected asSaved(content: string, _text: string): string {
    return content;
  }

  /** Reads what belongs to the file and is kept beside it. */
  protected async readBeside(): Promise<void> {}

  /** Saves that beside the file of this name, which may have been none before. */
  protected async saveBeside(_name: string, _isNew: boolean): Promise<void> {}

  /** What a saved file lacks, in words. */
  protected lackWords(): string {
    return "";
  }

  /** Shows the conflict with what is on disk now; a refusal is said. */
  async compare(): Promise<void> {
    await this.attempt(async () => {
      this.conflict.value = conflictWith(await this.written(this.name), await readIfThere(this.api, this.name));
    });
  }

  /** Takes what is on disk; undo brings back what was here. */
  readAgain(): Promise<void> {
    return this.queued(async () => {
      const { text, hash } = await this.api.read(this.name);
      await this.take(await this.contentOf(text), hash, `Read ${this.name} again`);
    });
  }

  /** Goes back to what is on disk; undo brings back what was restored. */
  dropRestored(): Promise<void> {
    return this.queued(async () => {
      const onDisk = await readIfThere(this.api, this.name);
      const content = await this.contentOf(onDisk?.text ?? null);
      await this.take(
        content,
        onDisk?.hash ?? null,
        onDisk ? `Read ${this.name} again` : `${this.name} is not on disk`,
      );
    });
  }

  /** Looks whether somebody else changed the file; where nothing is unsaved here, what is on disk is taken. */
  lookAtDisk(): Promise<void> {
    return this.queued(async () => {
      if (this.conflict.value !== null) return;
      const change = await diskChangeOf(this.api, this.name, this.saved.value.hash);
      this.diskChange.value = change;
      if (change !== "changed" || !this.isSaved.value) return;
      const onDisk = await this.api.read(this.name);
      const content = await this.contentOf(onDisk.text);
      // What was typed meanwhile is not replaced by what nobody asked for: it is told that the two differ.
      if (!this.isSaved.value) return;
      const message = `${this.name} was changed on disk and is read again. Undo brings back what was here`;
      await this.take(content, onDisk.hash, message);
    });
  }

  private async take(content: string, hash: string | null, message: string): Promise<void> {
    this.message.value = message;
    await batch(() => {
      this.conflict.value = this.diskChange.value = null;
      this.saved.value = { content, hash };
      return this.replace(content);
    });
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

/** A text that was not saved, since somebody else changed the file; `theirs` and `hash` are null where it is gone. */
export interface Conflict {
  mine: string;
  theirs: string | null;
  hash: string | null;
}

interface OnDisk {
  text: string;
  hash: string;
}

export type DiskChange = "changed" | "gone";

/** Saves a text where the file still has this hash; else nothing is written, and what is on disk is told. */
export async function saveOver(
  api: Api,
  name: string,
  text: string,
  baseHash: string | null,
): Promise<{ hash: string; note?: string } | Conflict> {
  try {
    return await api.save(name, text, baseHash);
  } catch (error) {
    if (!isStatus(error, 409)) throw error;
  }
  const onDisk = await readIfThere(api, name);
  // The same text, as after a save whose answer got lost, is saved.
  return onDisk?.text === text ? onDisk : conflictWith(text, onDisk);
}

/** What happened to a file that had this hash. */
export async function diskChangeOf(api: Api, name: string, hash: string | null): Promise<DiskChange | null> {
  const now = (await api.fileState(name)).hash;
  if (hash === now) return null;
  return now === null ? "gone" : "changed";
}

/** An own text beside what is on disk. */
function conflictWith(mine: string, onDisk: OnDisk | null): Conflict {
  return { mine, theirs: onDisk?.text ?? null, hash: onDisk?.hash ?? null };
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

const MOST_STEPS = 500;
const MOST_LETTERS = 50_000_000;
const TYPING_PAUSE_MS = 800;

/** Undo over everything: a stack of texts. Letters typed in one go are one step. */
export class History {
  private readonly past = signal<readonly string[]>([]);
  private readonly future = signal<readonly string[]>([]);
  private lastTypedMs = Number.NEGATIVE_INFINITY;

  readonly canUndo = computed(() => this.past.value.length > 0);
  readonly canRedo = computed(() => this.future.value.length > 0);

  /** Remembers the text before a change; `typedMs` is the time of a key stroke. */
  push(before: string, typedMs: number | null = null): void {
    const goesOn = typedMs !== null && typedMs - this.lastTypedMs < TYPING_PAUSE_MS;
    this.lastTypedMs = typedMs ?? Number.NEGATIVE_INFINITY;
    if (!(goesOn && this.canUndo.value)) this.past.value = newest([...this.past.value, before]);
    this.future.value = [];
  }

  /** The text to go back to, or null. */
  undo(current: string): string | null {
    return this.step(this.past, this.future, current);
  }

  /** The text to go forward to, or null. */
  redo(current: string): string | null {
    return this.step(this.future, this.past, current);
  }

  private step(from: typeof this.past, to: typeof this.past, current: string): string | null {
    const text = from.value.at(-1);
    if (text === undefined) return null;
    from.value = from.value.slice(0, -1);
    to.value = [...to.value, current];
    this.lastTypedMs = Number.NEGATIVE_INFINITY;
    return text;
  }
}

/** The last texts, as many as fit into memory. */
function newest(texts: readonly string[]): readonly string[] {
  let letters = 0;
  const dropped = texts.findLastIndex((text, index) => {
    letters += text.length;
    return letters > MOST_LETTERS || index < texts.length - MOST_STEPS;
  });
  return texts.slice(Math.min(dropped + 1, texts.length - 1));
}
