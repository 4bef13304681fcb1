// Who changed what, the newest first.

import type { Api } from '../api';
import { element } from '../dom';
import { Pager } from '../parts/pager';
import { Part } from '../parts/states';
import { table, type Cell } from '../parts/table';
import { moment } from '../parts/texts';
import type { AuditEntry } from '../wire';

const PAGE = 25;
const TYPING_MS = 300;

export class AuditList {
  private readonly resource = element('input', { type: 'search',
    placeholder: 'datasets/, models/arm ...',
    'aria-label': 'Only what begins with' });
  private readonly caller = element('input', { type: 'search',
    placeholder: 'who', 'aria-label': 'Only of' });
  private readonly part = new Part('Audit log', this.resource, this.caller);
  private readonly pager = new Pager(() => this.load());

  constructor(private readonly api: Api) {
    for (const input of [this.resource, this.caller]) {
      input.addEventListener('input', () => this.part.later(TYPING_MS, () => {
        this.pager.reset();
        this.load();
      }));
    }
    this.load();
  }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private load(): void {
    void this.part.load(async (signal) => {
      const { entries, next_page_token } = await this.api.call<{
        entries: AuditEntry[]; next_page_token: string; }>(
        'AdminService/ListAuditLog', { page_size: PAGE,
          page_token: this.pager.token,
          resource_prefix: this.resource.value.trim(),
          caller: this.caller.value.trim() }, signal);
      if (entries.length === 0) {
        return [element('p', { class: 'quiet' }, 'Nothing was changed.')];
      }
      return [table('Changes', ['When', 'Who', 'Did', 'To', 'Why', 'From'],
        entries.map((entry): Cell[] => [moment(entry.time_ms), entry.caller,
          entry.verb, entry.resource, entry.reason, entry.peer])),
      this.pager.view(next_page_token)];
    });
  }
}
