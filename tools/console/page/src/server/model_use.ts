// The models that a server has in memory, the largest first.

import { hrefOf } from '../address';
import { listAll, type Api } from '../api';
import { element } from '../dom';
import { Part } from '../parts/states';
import { link, table, type Cell } from '../parts/table';
import { bytes, nameParts, shortName } from '../parts/texts';
import type { ModelVersion } from '../wire';
import { plural } from '../words';

const AGAIN_MS = 15_000;

export class ModelUse {
  private readonly part = new Part('Models in memory');

  constructor(private readonly api: Api) { this.load(); }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private load(): void {
    void this.part.load(async (signal) => {
      const versions = await listAll<ModelVersion>(this.api,
        'ModelService/ListModelVersions', 'versions', signal);
      this.part.later(AGAIN_MS, () => this.load());
      const all = versions.reduce((sum, own) => sum + Number(own.bytes), 0);
      return [element('p', { class: 'quiet' }, `${plural(versions.length,
        'version')}, with bundles of ${bytes(all)}. A server keeps every ` +
        'version in memory; trainctl models delete removes one.'),
      table('Models in memory, the largest first', ['Version', 'Aliases',
        { title: 'Bundle', number: true }, 'By'],
      [...versions].sort((a, b) => Number(b.bytes) - Number(a.bytes))
        .map((version) => this.row(version)))];
    });
  }

  private row({ name, aliases, bytes: size, built_in, requester }:
      ModelVersion): Cell[] {
    return [link(hrefOf('train', this.api.server, 'model', ...nameParts(name)),
      shortName(name)), aliases.map(shortName).join(', '), bytes(size),
    built_in ? 'built in' : requester];
  }
}
