// Which version an alias named, when and by whom.

import { hrefOf } from '../address';
import type { Api } from '../api';
import { Part } from '../parts/states';
import { link, table, type Cell } from '../parts/table';
import { moment, nameParts, shortName } from '../parts/texts';
import type { AliasChange } from '../wire';

export class AliasHistory {
  private readonly part = new Part('History');

  constructor(api: Api, alias: string) {
    void this.part.load(async (signal) => {
      const { changes } = await api.call<{ changes: AliasChange[] }>(
        'ModelService/ListAliasHistory', { name: `aliases/${alias}` }, signal);
      return [table('Changes, the newest first', ['When', 'Named', 'By', 'How'],
        changes.map((change): Cell[] => [moment(change.time_ms),
          link(hrefOf('train', api.server, 'model',
            ...nameParts(change.model_version)),
          shortName(change.model_version)), change.requester,
          change.rollback ? 'rolled back' :
            change.forced ? 'promoted, the gate overruled' : 'promoted']))];
    });
  }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }
}
