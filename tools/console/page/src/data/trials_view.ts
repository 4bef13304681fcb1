// The trials of a version: filtered, page by page, to be relabelled or removed.

import { hrefOf } from '../address';
import { newRequestId, type Api } from '../api';
import { element, setText } from '../dom';
import { ask, type Field } from '../parts/dialog';
import { Part, tellDone } from '../parts/states';
import { button, buttons, table, type Cell } from '../parts/table';
import { nameParts } from '../parts/texts';
import type { DatasetVersion, Trial } from '../wire';
import { plural } from '../words';
import { TrialList } from './trial_list';

const ROWS = 50;
const TYPING_MS = 250;

export class TrialsView {
  private readonly part: Part;
  private readonly label: HTMLSelectElement;
  private readonly text = element('input', { type: 'search',
    placeholder: 'id, condition, object ...', 'aria-label': 'Filter by text' });
  private readonly relabel = button('Relabel ...', () => this.askRelabel());
  private readonly remove = button('Remove ...', () => this.askRemove(),
    'danger');
  private readonly rights = element('p', { class: 'quiet' });
  private readonly picked = new Set<string>();
  private list: TrialList;
  private first = 0;
  // True until the server says that the person may not change datasets.
  private mayEdit = true;

  constructor(private readonly api: Api,
      private readonly version: DatasetVersion,
      private readonly isNewest: boolean) {
    this.label = element('select', { 'aria-label': 'Filter by label' },
      element('option', { value: '' }, 'all labels'),
      ...Object.entries(version.labels).sort(([a], [b]) => a < b ? -1 : 1)
        .filter(([name]) => name !== '').map(([name, count]) =>
          element('option', { value: name }, `${name} (${count})`)));
    this.part = new Part(`Trials of @${nameParts(version.name)[1]}`,
      this.label, this.text, buttons(this.relabel, this.remove));
    this.list = this.newList();
    this.label.addEventListener('change', () => {
      this.list = this.newList();
      this.goTo(0);
    });
    this.text.addEventListener('input', () =>
      this.part.later(TYPING_MS, () => this.goTo(0)));
    this.showPicked();
    this.goTo(0);
    void api.may('trainer').then((may) => {
      if (may !== false) return;
      this.mayEdit = false;
      this.showPicked();
    });
  }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private newList(): TrialList {
    return new TrialList(this.api, this.version.name, this.label.value);
  }

  private get dataset(): string { return nameParts(this.version.name)[0]!; }

  private goTo(first: number): void {
    this.first = Math.max(0, first);
    void this.part.load(async (signal) => {
      const { trials, more } = await this.list.slice(this.text.value,
        this.first, ROWS, signal);
      return this.rows(trials, more);
    });
  }

  private rows(trials: Trial[], more: boolean): Node[] {
    if (trials.length === 0) {
      return [element('p', { class: 'quiet' }, 'No trial is like that.')];
    }
    const rows = trials.map((trial): Cell[] => [this.box(trial), trial.id,
      trial.label || '(no label)', trial.condition,
      [trial.object, trial.material].filter((text) => text).join(', '),
      trial.layout, String(trial.frames), trial.source]);
    const back = button('← Before', () => this.goTo(this.first - ROWS));
    const on = button('After →', () => this.goTo(this.first + ROWS));
    back.disabled = this.first === 0;
    on.disabled = !more;
    const optional = (title: string) => ({ title, optional: true });
    return [this.rights, table('Trials', ['', 'Trial', 'Label',
      optional('Condition'), optional('Object'), optional('Layout'),
      { title: 'Frames', number: true }, optional('Recording')], rows),
    element('div', { class: 'pager' }, element('p', { class: 'quiet' },
      `${this.first + 1} to ${this.first + trials.length}`), back, on)];
  }

  private box(trial: Trial): HTMLElement {
    const box = element('input', { type: 'checkbox',
      'aria-label': `Choose ${trial.id}` });
    box.checked = this.picked.has(trial.id);
    box.disabled = !this.isNewest || !this.mayEdit;
    box.addEventListener('change', () => {
      if (box.checked) this.picked.add(trial.id);
      else this.picked.delete(trial.id);
      this.showPicked();
    });
    return box;
  }

  private showPicked(): void {
    const count = this.picked.size;
    const may = this.isNewest && this.mayEdit;
    for (const tool of [this.relabel, this.remove]) {
      tool.disabled = !may || count === 0;
    }
    setText(this.relabel, count > 0 ? `Relabel ${count} ...` : 'Relabel ...');
    setText(this.remove, count > 0 ? `Remove ${count} ...` : 'Remove ...');
    setText(this.rights, !this.mayEdit ?
      'Read-only: your role may not change datasets.' : !this.isNewest ?
        'Versions never change: only trials of the newest version can be ' +
        'relabelled or removed.' : count > 0 ?
          `${plural(count, 'trial')} chosen.` :
          'Choose trials to relabel or remove them. That makes a new version.');
    if (may) return;
    for (const box of this.root.querySelectorAll('td input')) {
      (box as HTMLInputElement).disabled = true;
    }
  }

  private askRelabel(): void {
    this.askChange('Relabel', [{ name: 'label', label: 'New label',
      required: true, list: Object.keys(this.version.labels) }],
    'TrainingService/RelabelTrials', false);
  }

  private askRemove(): void {
    this.askChange('Remove', [], 'TrainingService/RemoveTrials', true);
  }

  private askChange(verb: string, fields: Field[], method: string,
      danger: boolean): void {
    const trials = [...this.picked];
    const request_id = newRequestId();
    ask({
      title: `${verb} ${plural(trials.length, 'trial')}`,
      text: 'This makes a new version. The present one stays as it is.',
      fields: [...fields, { name: 'reason', label: 'Reason', required: true,
        hint: 'It stands in the list of versions and in the audit log.' }],
      action: verb, danger,
      run: async (values) => {
        const { version } = await this.api.call<{ version: DatasetVersion }>(
          method, { dataset: `datasets/${this.dataset}`, trials, ...values,
            request_id });
        const number = nameParts(version.name)[1]!;
        tellDone(`${verb === 'Remove' ? 'Removed' : 'Relabelled'} ` +
          `${plural(trials.length, 'trial')}: this is ` +
          `${this.dataset}@${number} now.`, true);
        location.hash = hrefOf('data', this.api.server, this.dataset, number);
      },
    });
  }
}
