// The data page: datasets, or one of them.

import { hrefOf } from '../address';
import { listAll } from '../api';
import { element } from '../dom';
import type { Page, PageContext, PageKind } from '../page';
import { emptyBox, Part } from '../parts/states';
import { link, pageHead, table } from '../parts/table';
import { moment, shortName } from '../parts/texts';
import type { Dataset } from '../wire';
import { DatasetView } from './dataset_view';
import { ImportView } from './import_view';

export const DATA: PageKind = {
  id: 'data',
  title: 'Data',
  ofOneServer: true,
  open: (context) => new DataPage(context),
};

class DataPage implements Page {
  private view?: { close(): void };
  private dataset?: DatasetView;

  constructor(private readonly context: PageContext) {}

  // "arm/3" is version 3 of the dataset arm.
  show([name, version]: string[]): void {
    if (name !== undefined && this.dataset?.dataset === name) {
      return this.dataset.show(version);
    }
    this.close();
    this.dataset = undefined;
    const { main, api } = this.context;
    if (name === undefined) {
      const list = new Part('All datasets');
      const load = () => showDatasets(this.context, list);
      const files = new ImportView(api, '', load);
      this.view = { close: () => { list.close(); files.close(); } };
      main.replaceChildren(element('div', { class: 'page' },
        pageHead('Datasets'), list.root, files.root));
      return load();
    }
    this.dataset = new DatasetView(api, name);
    this.view = this.dataset;
    main.replaceChildren(this.dataset.root);
    this.dataset.show(version);
  }

  close(): void { this.view?.close(); }
}

function showDatasets({ api }: PageContext, part: Part): void {
  void part.load(async (signal) => {
    const datasets = await listAll<Dataset>(api,
      'TrainingService/ListDatasets', 'datasets', signal);
    if (datasets.length === 0) {
      return [emptyBox('There is no dataset yet', 'Import files below, or ' +
        'make one and upload labelled trials to it:',
      `trainctl datasets create arm --server=${api.address}\n` +
      `trainctl datasets upload arm --data=trials.h5 --server=${api.address}`)];
    }
    return [table('Datasets',
      ['Dataset', 'Description', 'Newest version', 'Made', 'By'],
      datasets.map((dataset) => {
        const name = shortName(dataset.name);
        const newest = dataset.latest_version;
        return [link(hrefOf('data', api.server, name), name),
          dataset.description,
          newest === 0 ? 'none: nothing was uploaded' :
            link(hrefOf('data', api.server, name, String(newest)),
              `${name}@${newest}`),
          moment(dataset.create_time_ms), dataset.requester];
      }))];
  });
}
