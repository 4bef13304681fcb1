// The labels that are not saved yet, the dataset that they go to, and the
// button that saves them all in one new version of it.

import { hrefOf } from '../address';
import { ApiError, type Api } from '../api';
import { element, setText } from '../dom';
import { DatasetChoice } from '../parts/dataset_choice';
import { errorBox } from '../parts/states';
import { button, link } from '../parts/table';
import { nameParts, shortName } from '../parts/texts';
import type { DatasetVersion } from '../wire';
import { plural } from '../words';
import type { Drafts } from './drafts';
import { lookAgain } from './gone';
import type { ContactLabel } from './messages';

export class LabelBar {
  readonly root: HTMLElement;
  private readonly count = element('p', { class: 'count' });
  private readonly dataset: DatasetChoice;
  private readonly reason = element('input', { type: 'text', maxlength: '1024',
    id: 'label-reason', autocomplete: 'off', placeholder: 'why, for people' });
  private readonly undo: HTMLButtonElement;
  private readonly save = button('Save', () => void this.run(), 'main');
  private readonly told = element('div', { class: 'told', role: 'status' });
  private busy = false;
  // Whether there is something to label.
  private useful = false;

  constructor(private readonly api: Api, private readonly drafts: Drafts,
      onUndo: () => void, private readonly onSaved: () => void) {
    this.undo = button('', onUndo);
    this.undo.append(element('kbd', { 'aria-hidden': 'true' }, 'u'),
      element('span', {}, 'Undo'));
    this.undo.setAttribute('aria-keyshortcuts', 'u');
    this.dataset = new DatasetChoice(api, 'label-dataset', (name) =>
      drafts.choose(name, this.reason.value));
    const tools = element('div', { class: 'label-bar-tools' }, this.count,
      element('label', { for: 'label-dataset' }, 'for'), this.dataset.root,
      element('label', { for: 'label-reason' }, 'Reason'), this.reason,
      this.undo, this.save);
    this.root = element('section', { class: 'card label-bar',
      'aria-label': 'Labels that are not saved' }, tools, this.told);
    this.reason.value = drafts.reason;
    this.reason.addEventListener('input', () =>
      drafts.choose(this.dataset.value, this.reason.value));
    this.show();
    void this.dataset.read(drafts.dataset);
  }

  show(): void {
    const { size, steps } = this.drafts;
    setText(this.count, size === 0 ? 'No new label' : plural(size, 'label'));
    this.undo.disabled = steps === 0 || this.busy;
    this.save.disabled = size === 0 || this.busy;
    this.root.hidden = !this.useful && size === 0 && steps === 0 &&
      this.told.children.length === 0;
  }

  setUseful(useful: boolean): void {
    this.useful = useful;
    this.show();
  }

  // Says what has come of the last thing that was done here.
  tell(...nodes: Node[]): void {
    this.told.replaceChildren(...nodes);
    this.show();
  }

  private async run(): Promise<void> {
    if (this.busy || this.drafts.size === 0) return;
    if (this.drafts.dataset === '') {
      this.tell(element('p', { class: 'error' }, 'Choose the dataset that ' +
        'the labels are for.'));
      return this.dataset.root.focus();
    }
    this.busy = true;
    this.tell();
    const request = this.drafts.request() as { labels: ContactLabel[] };
    try {
      const { version } = await this.api.call<{ version: DatasetVersion }>(
        'ContactLogService/LabelContacts', request);
      this.busy = false;
      this.reason.value = '';
      this.drafts.saved(request.labels);
      const [name, number] = nameParts(version.name);
      this.tell(element('p', { class: 'done' },
        `Saved ${plural(request.labels.length, 'label')}: this is `,
        link(hrefOf('data', this.api.server, name!, number!),
          shortName(version.name)), ' now.'));
      this.onSaved();
    } catch (error) {
      this.busy = false;
      this.tell(errorBox(error));
      if (error instanceof ApiError && error.reason === 'CONTACT_NOT_FOUND') {
        await this.offerToLeaveOut(request.labels).catch(() => undefined);
      }
    }
  }

  // The log may have dropped contacts since they were labelled.
  private async offerToLeaveOut(labels: ContactLabel[]): Promise<void> {
    const names = labels.map(({ contact }) => contact);
    const there = new Set((await lookAgain(this.api, names))
      .map(({ name }) => name));
    const gone = names.filter((name) => !there.has(name));
    if (gone.length === 0) return;
    const tool = button(`Leave out ${gone.length} that the log has dropped`,
      () => {
        this.tell();
        this.drafts.leaveOut(gone);
      });
    this.told.firstElementChild?.append(tool);
  }
}
