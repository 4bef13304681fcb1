// One import, as the console has it: its files, what trainctl says of them, and
// the version that becomes of them.

import { ApiError, type Api } from '../api';
import type { DatasetVersion } from '../wire';
import { bytes } from '../parts/texts';
import type { PickedFile } from './picked_files';

// What trainctl answers: what it prints, or why it refuses.
export interface Answer<Result> {
  accepted: boolean;
  remarks: string[];
  result?: Result;
  error?: string;
}

export interface ReadResult {
  trials: number;
  frames: number;
  counts: Record<string, number>;
  conditions: number;
  groups: number;
  with_poses: number;
  never_felt: number;
  duplicates: number;
  skin?: { layout: string; rows: number; columns: number } | null;
}

export interface TrialNote {
  kind: string;
  id: string;
  source: string;
  label: string;
  other_id: string;
  other_source: string;
  other_label: string;
  new_id: string;
}

export interface SentResult {
  version: DatasetVersion;
  notes: TrialNote[];
}

interface Begun {
  id: string;
  file_bytes: number;
  bytes: number;
  files: number;
}

export class ImportSession {
  private begun?: Begun;
  private readonly sent = new Set<File>();

  constructor(private readonly api: Api) {}

  // With `replaces`, another import of the person's ends.
  async begin(replaces: boolean, signal: AbortSignal): Promise<void> {
    this.begun = await this.api.send<Begun>(
      this.path('begin') + (replaces ? '?replace=1' : ''), {}, signal);
  }

  // True if all files that the console has are among these.
  hasOnly(files: PickedFile[]): boolean {
    const own = new Set(files.map(({ file }) => file));
    return [...this.sent].every((file) => own.has(file));
  }

  // Those that the console does not have. `onSent` gets bytes, of how many.
  async send(files: PickedFile[], signal: AbortSignal,
      onSent: (bytes: number, all: number) => void): Promise<void> {
    this.checkSizes(files);
    const news = files.filter(({ file }) => !this.sent.has(file));
    const all = sizeOf(news);
    let done = 0;
    onSent(0, all);
    for (const { name, file } of news) {
      await this.api.send(`${this.path('file')}&name=` +
        encodeURIComponent(name), file, signal, (count) =>
        onSent(done + Math.min(count, file.size), all));
      this.sent.add(file);
      done += file.size;
      onSent(done, all);
    }
  }

  check(options: object, signal: AbortSignal): Promise<Answer<ReadResult>> {
    return this.api.send(this.path('check'), options, signal);
  }

  finish(options: object, signal: AbortSignal): Promise<Answer<SentResult>> {
    return this.api.send(this.path('finish'), options, signal);
  }

  // The console forgets the files.
  end(): void {
    if (this.begun) this.api.tell(this.path('end'));
    this.begun = undefined;
  }

  private path(step: string): string {
    const path = `/api/import/${this.api.server}/${step}`;
    return this.begun ? `${path}?id=${this.begun.id}` : path;
  }

  // Before any of it is sent.
  private checkSizes(files: PickedFile[]): void {
    const most = this.begun!;
    const refuse = (text: string): never => {
      throw new ApiError('', '', `${text} Use trainctl import for more.`);
    };
    const large = files.find(({ file }) => file.size > most.file_bytes);
    if (large) {
      refuse(`${large.name} has ${bytes(large.file.size)}; a file has at ` +
        `most ${bytes(most.file_bytes)}.`);
    }
    if (files.length > most.files) {
      refuse(`There are ${files.length} files; an import has at most ` +
        `${most.files}.`);
    }
    if (sizeOf(files) > most.bytes) {
      refuse(`The files have ${bytes(sizeOf(files))} together; an import has ` +
        `at most ${bytes(most.bytes)}.`);
    }
  }
}

export function sizeOf(files: PickedFile[]): number {
  return files.reduce((sum, { file }) => sum + file.size, 0);
}
