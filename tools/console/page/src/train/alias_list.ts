// The aliases of a server: which version each names, and what changes that.

import { hrefOf } from '../address';
import type { Api } from '../api';
import { emptyBox, Part } from '../parts/states';
import { button, buttons, link, table, type Cell } from '../parts/table';
import { nameParts, shortName } from '../parts/texts';
import type { Alias, Gate } from '../wire';
import { askCanary, askGate, askRollback } from './alias_questions';

export class AliasList {
  private readonly part = new Part('Aliases');

  constructor(private readonly api: Api) { this.load(); }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  load(): void {
    void this.part.load(async (signal) => {
      const { aliases } = await this.api.call<{ aliases: Alias[] }>(
        'ModelService/ListAliases', {}, signal);
      const may = await this.api.may('admin') !== false;
      if (aliases.length === 0) {
        return [emptyBox('No alias yet', 'Streams get the model that the ' +
          'server carries. Promote a version to the alias "default", and ' +
          'streams get that.')];
      }
      return [table('Aliases', ['Alias', 'Names', 'Before that', 'Canary',
        'Gate', ''], aliases.map((alias) => this.row(alias, may)))];
    });
  }

  private row(alias: Alias, may: boolean): Cell[] {
    const { api } = this;
    const name = shortName(alias.name);
    const again = () => this.load();
    const rollback = button('Roll back ...',
      () => askRollback(api, alias, again));
    rollback.disabled = !may || alias.previous_version === '';
    const canary = button('Canary ...',
      () => void askCanary(api, alias, again));
    const gate = button('Gate ...', () => void askGate(api, alias, again));
    canary.disabled = gate.disabled = !may;
    for (const tool of [rollback, canary, gate]) {
      tool.setAttribute('aria-label', `${tool.textContent} ${name}`);
    }
    return [link(hrefOf('train', api.server, 'alias', name), name),
      this.versionLink(alias.model_version),
      this.versionLink(alias.previous_version),
      alias.canary ? `${alias.canary.per_mille / 10} % get ` +
        shortName(alias.canary.model_version) : 'none',
      alias.gate ? gateText(alias.gate) : 'none',
      buttons(rollback, canary, gate)];
  }

  private versionLink(version: string): Cell {
    return version === '' ? '–' : link(hrefOf('train', this.api.server, 'model',
      ...nameParts(version)), shortName(version));
  }
}

function gateText(gate: Gate): string {
  return `on ${shortName(gate.dataset_version)}: accuracy ` +
    `−${gate.accuracy_margin}, log-loss +${gate.log_loss_margin}, ` +
    `calibration +${gate.calibration_margin}`;
}
