// One dataset: its versions, what changed between them, and the trials of one.

import { hrefOf } from '../address';
import type { Api } from '../api';
import { element } from '../dom';
import { emptyBox, Part } from '../parts/states';
import { bars, link, pageHead, table, type Cell } from '../parts/table';
import { bytes, moment, nameParts } from '../parts/texts';
import type { Dataset, DatasetVersion } from '../wire';
import { differenceView } from './difference';
import { ImportView } from './import_view';
import { TrialsView } from './trials_view';

export class DatasetView {
  readonly root: HTMLElement;
  private readonly versions = new Part('Versions');
  private readonly labels = new Part('Labels');
  private readonly difference = new Part('What changed');
  private trials?: TrialsView;
  private readonly place = element('div');
  private readonly description = element('p', { class: 'model' });
  private readonly files: ImportView;
  private all?: DatasetVersion[];
  // The version that the address names.
  private number?: string;

  constructor(private readonly api: Api, readonly dataset: string) {
    this.files = new ImportView(api, dataset, () => {
      this.all = undefined;
      this.show(this.number);
    });
    this.root = element('div', { class: 'page' },
      pageHead(dataset, link(hrefOf('data', api.server), '← All datasets'),
        this.description),
      element('div', { class: 'columns' }, this.versions.root,
        this.labels.root, this.difference.root),
      this.place, this.files.root);
  }

  // Of version `number`; the newest one if undefined.
  show(number?: string): void {
    this.number = number;
    void this.versions.load(async (signal) => {
      const known = this.all?.some((v) => numberOf(v) === number);
      if (!known) await this.read(signal);
      this.showVersion(number);
      return [this.versionTable(number)];
    });
  }

  close(): void {
    this.versions.close();
    this.labels.close();
    this.difference.close();
    this.trials?.close();
    this.files.close();
  }

  private async read(signal?: AbortSignal): Promise<void> {
    const { dataset, versions } = await this.api.call<{ dataset: Dataset;
      versions: DatasetVersion[]; }>('TrainingService/GetDataset',
      { name: `datasets/${this.dataset}` }, signal);
    this.description.textContent = dataset.description;
    this.all = versions;
  }

  private chosen(number?: string): DatasetVersion | undefined {
    return this.all?.find((version) => numberOf(version) === number) ??
      this.all?.[this.all.length - 1];
  }

  private versionTable(number?: string): HTMLElement {
    const chosen = this.chosen(number);
    if (chosen === undefined) {
      return emptyBox('Nothing was uploaded yet', 'Import files below, or ' +
        'upload labelled trials:',
        `trainctl datasets upload ${this.dataset} --data=trials.h5 ` +
        `--server=${this.api.address}`);
    }
    const rows = [...this.all!].reverse().map((version): Cell[] => {
      const own = numberOf(version);
      const way = link(hrefOf('data', this.api.server, this.dataset, own),
        `@${own}`);
      if (version === chosen) way.setAttribute('aria-current', 'true');
      return [way, changeOf(version), String(version.trials),
        moment(version.create_time_ms), version.requester];
    });
    return table('Versions, the newest first', ['Version', 'Change',
      { title: 'Trials', number: true }, 'Made', 'By'], rows);
  }

  private showVersion(number?: string): void {
    const version = this.chosen(number);
    this.trials?.close();
    this.trials = undefined;
    this.labels.root.hidden = version === undefined;
    this.difference.root.hidden = (this.all?.length ?? 0) < 2;
    this.place.replaceChildren();
    if (version === undefined) return;
    const counts = Object.entries(version.labels).sort(([a], [b]) =>
      a < b ? -1 : 1);
    this.labels.show(bars(counts), element('p', { class: 'quiet' },
      `${version.trials} trials, ${bytes(version.bytes)}`));
    this.difference.show(differenceView(this.all!, version));
    const newest = this.all![this.all!.length - 1] === version;
    this.trials = new TrialsView(this.api, version, newest);
    this.place.replaceChildren(this.trials.root);
  }
}

function numberOf(version: DatasetVersion): string {
  return nameParts(version.name)[1]!;
}

// What a version changed, in words: "+80", or "2 relabelled: a typo".
function changeOf(version: DatasetVersion): string {
  const counts = [
    version.relabelled > 0 ? `${version.relabelled} relabelled` : '',
    version.relabelled === 0 && version.added > 0 ? `+${version.added}` : '',
    version.relabelled === 0 && version.removed > 0 ?
      `−${version.removed}` : '',
    version.duplicates > 0 ? `${version.duplicates} known already` : '',
    version.renamed > 0 ? `${version.renamed} renamed` : '',
  ].filter((text) => text !== '').join(', ') || 'no trial changed';
  return version.reason ? `${counts}: ${version.reason}` : counts;
}
