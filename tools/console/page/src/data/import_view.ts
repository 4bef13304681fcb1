// The import of files: they are chosen or dropped, sent to the console, read
// there, and become a version of a dataset once a person has seen what is in
// them.

import { ApiError, type Api } from '../api';
import { element, setText } from '../dom';
import { DatasetChoice } from '../parts/dataset_choice';
import { errorBox } from '../parts/states';
import { button, buttons } from '../parts/table';
import { bytes } from '../parts/texts';
import { plural } from '../words';
import { ImportOptions } from './import_options';
import { readView, refusal, sentView } from './import_result';
import { ImportSession, sizeOf } from './import_session';
import { filesOfDrop, filesOfInput, type Picked, type PickedFile } from
  './picked_files';

const SHOWN_FILES = 6;

export class ImportView {
  readonly root: HTMLElement;
  private readonly chooseFiles = button('Choose files ...', () =>
    this.filesInput.click());
  private readonly chooseFolder = button('Choose a folder ...', () =>
    this.folderInput.click());
  private readonly filesInput = fileInput();
  private readonly folderInput = fileInput();
  private readonly rights = element('p', { class: 'quiet' });
  private readonly drop: HTMLElement;
  private readonly list = element('ul', { class: 'picked',
    'aria-label': 'Files to import' });
  private readonly options = new ImportOptions(() => this.changed());
  private readonly check = button('Check', () => void this.runCheck(), 'main');
  private readonly status = element('p', { role: 'status' });
  private readonly count = element('span', { class: 'quiet' });
  private readonly bar = element('progress', { 'aria-label': 'Sent' });
  private readonly cancel = button('Cancel', () => this.stop());
  private readonly result = element('div', { class: 'import-answer' });
  private readonly dataset: DatasetChoice;
  private readonly replace = element('input', { type: 'checkbox',
    id: 'import-replace' });
  private readonly finish = button('Import', () => void this.runFinish(),
    'main');
  private readonly form: HTMLElement;
  private readonly target: HTMLElement;
  private readonly progress: HTMLElement;
  private files: PickedFile[] = [];
  private session?: ImportSession;
  private aborter?: AbortController;
  private mayImport = true;

  // `dataset`: the one that files are for at first; `onDone`: there is a new
  // version of one.
  constructor(private readonly api: Api, dataset: string,
      private readonly onDone: () => void) {
    this.folderInput.setAttribute('webkitdirectory', '');
    this.dataset = new DatasetChoice(api, 'import-dataset', () =>
      this.showBusy());
    this.drop = element('div', { class: 'drop' },
      element('p', {}, 'Drop files or a folder here, or'),
      buttons(this.chooseFiles, this.chooseFolder),
      element('p', { class: 'hint' }, 'Trial files (.h5), recordings ' +
        '(.mcap), signals (.csv, .npz), or frames with a skin.json and a ' +
        'table. They are read as trainctl import reads them, and nothing ' +
        'goes to the server before you have seen what is in them.'),
      this.rights, this.filesInput, this.folderInput);
    this.form = element('div', { class: 'import-form' }, this.list,
      this.options.root, buttons(this.check));
    this.progress = element('div', { class: 'import-progress' }, this.bar,
      this.count, this.cancel);
    this.target = element('div', { class: 'import-target' },
      element('label', { for: 'import-dataset' }, 'Into the dataset'),
      this.dataset.root, element('div', { class: 'check' }, this.replace,
        element('label', { for: 'import-replace' },
          'Replace labels of recordings that are there')), this.finish);
    this.root = element('section', { class: 'card part', 'aria-label':
      'Import files' }, element('header', { class: 'part-head' },
      element('h2', {}, 'Import files')), this.drop, this.form, this.status,
    this.progress, this.result, this.target);
    for (const input of [this.filesInput, this.folderInput]) {
      input.addEventListener('change', () => {
        this.add(filesOfInput(input.files!));
        input.value = '';
      });
    }
    for (const kind of ['dragenter', 'dragover', 'dragleave', 'drop']) {
      document.addEventListener(kind, this.onDrag as EventListener);
    }
    addEventListener('pagehide', this.leave);
    this.show();
    void this.dataset.read(dataset);
    void api.may('trainer').then((may) => {
      if (may !== false) return;
      this.mayImport = false;
      setText(this.rights, 'Read-only: your role may not change datasets.');
      this.showBusy();
    });
  }

  close(): void {
    for (const kind of ['dragenter', 'dragover', 'dragleave', 'drop']) {
      document.removeEventListener(kind, this.onDrag as EventListener);
    }
    removeEventListener('pagehide', this.leave);
    this.leave();
  }

  private readonly leave = (): void => {
    this.aborter?.abort();
    this.session?.end();
    this.session = undefined;
  };

  // A file that is dropped beside the place for it would replace the page.
  private readonly onDrag = (event: DragEvent): void => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    const isHere = event.target instanceof Node &&
      this.root.contains(event.target) && this.mayImport && !this.isBusy;
    event.dataTransfer.dropEffect = isHere ? 'copy' : 'none';
    this.drop.classList.toggle('is-over', isHere && event.type !== 'drop' &&
      event.type !== 'dragleave');
    if (!isHere || event.type !== 'drop') return;
    filesOfDrop(event.dataTransfer).then((picked) => this.add(picked),
      (error) => this.showResult(errorBox(error)));
  };

  private get isBusy(): boolean { return this.aborter !== undefined; }

  private add({ files, hidden }: Picked): void {
    const names = new Set(files.map(({ name }) => name));
    this.files = [...this.files.filter(({ name }) => !names.has(name)),
      ...files].sort((a, b) => a.name < b.name ? -1 : 1);
    this.changed();
    this.show();
    setText(this.status, (files.length === 0 ? 'There is no file in that.' :
      `${plural(this.files.length, 'file')} to import.`) + (hidden > 0 ?
      ` ${plural(hidden, 'hidden file')} left out.` : ''));
    if (this.files.length > 0) this.check.focus({ preventScroll: true });
  }

  private remove(file?: PickedFile): void {
    this.files = file ? this.files.filter((other) => other !== file) : [];
    this.changed();
    this.show();
    const next = this.list.querySelector<HTMLElement>('button') ??
      this.chooseFiles;
    next.focus({ preventScroll: true });
  }

  // What was read before is not what would be imported now.
  private changed(): void {
    this.showResult();
    setText(this.status, '');
  }

  private show(): void {
    const { files } = this;
    this.form.hidden = files.length === 0;
    const rows = files.slice(0, SHOWN_FILES).map((file) => element('li', {},
      element('span', { class: 'name' }, file.name),
      element('span', { class: 'quiet' }, bytes(file.file.size)),
      named('Remove', file.name, () => this.remove(file))));
    if (files.length > 1) {
      const rest = files.length - rows.length;
      rows.push(element('li', {}, element('span', { class: 'name' },
        rest > 0 ? `and ${plural(rest, 'more file')}` : 'All'),
      element('span', { class: 'quiet' }, bytes(sizeOf(files))),
      named('Remove', 'all files', () => this.remove())));
    }
    this.list.replaceChildren(...rows);
    this.options.show(files);
    this.showBusy();
  }

  private showBusy(): void {
    const stopped = this.isBusy || !this.mayImport;
    for (const tool of [this.chooseFiles, this.chooseFolder, this.check,
      this.replace, this.dataset.root,
      ...this.list.querySelectorAll('button')]) {
      tool.disabled = stopped;
    }
    this.options.disable(stopped);
    this.finish.disabled = stopped || this.dataset.value === '';
    this.progress.hidden = !this.isBusy;
  }

  // Without what follows when there are trials that may become a version.
  private showResult(...nodes: Node[]): void {
    this.result.replaceChildren(...nodes);
    this.target.hidden = true;
  }

  private stop(): void {
    this.leave();
    setText(this.status, 'Cancelled. Nothing was imported.');
  }

  private async runCheck(replaces = false): Promise<void> {
    const values = this.options.values();
    await this.run(async (signal) => {
      const session = await this.sessionFor(replaces, signal);
      this.tell(`Sending ${plural(this.files.length, 'file')} to the console.`);
      await session.send(this.files, signal, (sent, all) => {
        this.bar.max = Math.max(all, 1);
        this.bar.value = sent;
        setText(this.count, `${bytes(sent)} of ${bytes(all)}`);
      });
      this.tell('Reading the files.');
      const answer = await session.check(values, signal);
      if (!answer.accepted) {
        setText(this.status, '');
        this.showResult(...refusal(answer));
        return undefined;
      }
      setText(this.status, 'Nothing is on the server yet.');
      this.showResult(...readView(answer));
      this.replace.checked = false;
      this.target.hidden = false;
      return this.dataset.root;
    }, this.check);
  }

  private async runFinish(): Promise<void> {
    const { session } = this;
    if (session === undefined) return this.runCheck();
    await this.run(async (signal) => {
      this.tell(`Importing into ${this.dataset.value}.`);
      const answer = await session.finish({ dataset: this.dataset.value,
        replace_labels: this.replace.checked }, signal);
      if (!answer.accepted) {
        setText(this.status, 'The server has refused the trials.');
        // The person may allow what was refused.
        this.result.replaceChildren(...refusal(answer));
        return this.replace;
      }
      this.session = undefined;
      this.files = [];
      this.show();
      setText(this.status, 'Imported.');
      this.showResult(...sentView(this.api, answer));
      this.onDone();
      return this.result.querySelector('a')!;
    }, this.finish);
  }

  // Its files are among those that are to be imported.
  private async sessionFor(replaces: boolean, signal: AbortSignal):
      Promise<ImportSession> {
    if (this.session && !this.session.hasOnly(this.files)) {
      this.session.end();
      this.session = undefined;
      // The person's own one is still ending.
      replaces = true;
    }
    if (this.session) return this.session;
    const session = new ImportSession(this.api);
    await session.begin(replaces, signal);
    this.session = session;
    return session;
  }

  private tell(text: string): void {
    setText(this.status, text);
    setText(this.count, '');
    this.bar.removeAttribute('value');
  }

  // Does work that can be cancelled. Then the focus is on what work returns, or
  // where it was.
  private async run(work: (signal: AbortSignal) =>
      Promise<HTMLElement | undefined>, from: HTMLElement): Promise<void> {
    if (this.isBusy) return;
    const aborter = new AbortController();
    this.aborter = aborter;
    this.showBusy();
    this.cancel.focus({ preventScroll: true });
    let next: HTMLElement | undefined;
    try {
      next = await work(aborter.signal);
    } catch (error) {
      if (!aborter.signal.aborted) this.fail(error);
    }
    const hadFocus = document.activeElement === this.cancel ||
      document.activeElement === document.body;
    this.aborter = undefined;
    this.showBusy();
    if (hadFocus) (next ?? from).focus({ preventScroll: !next });
  }

  // What the console has may be gone.
  private fail(error: unknown): void {
    this.session?.end();
    this.session = undefined;
    setText(this.status, '');
    const box = errorBox(error);
    const isOwn = error instanceof ApiError && error.metadata.import === 'own';
    if (isOwn) {
      box.append(button('End it and go on', () => void this.runCheck(true)));
    }
    this.showResult(box);
  }
}

// Its button is what people see and reach.
function fileInput(): HTMLInputElement {
  return element('input', { type: 'file', multiple: '', hidden: '' });
}

function named(text: string, what: string, onClick: () => void):
    HTMLButtonElement {
  const made = button(text, onClick);
  made.setAttribute('aria-label', `${text} ${what}`);
  return made;
}
