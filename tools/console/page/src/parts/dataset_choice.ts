// The choice of a dataset that something goes to: one that there is, or a new
// one.

import { listAll, type Api } from '../api';
import { element } from '../dom';
import type { Dataset } from '../wire';
import { ask } from './dialog';
import { shortName } from './texts';

// No dataset has such a name.
const NEW = ' new';

export class DatasetChoice {
  readonly root: HTMLSelectElement;
  private chosen = '';

  // `onChoose` gets the name; empty: none is chosen.
  constructor(private readonly api: Api, id: string,
      private readonly onChoose: (dataset: string) => void) {
    this.root = element('select', { id });
    this.root.addEventListener('change', () => this.change());
  }

  // The name of the dataset; empty without one.
  get value(): string { return this.chosen; }

  // Reads which there are, and shows that `chosen` is chosen.
  async read(chosen: string): Promise<void> {
    this.chosen = chosen;
    let names: string[] = [];
    try {
      names = (await listAll<Dataset>(this.api, 'TrainingService/ListDatasets',
        'datasets')).map(({ name }) => shortName(name));
    } catch {
      // Whatever is done with the dataset says what is wrong.
    }
    if (chosen && !names.includes(chosen)) names.push(chosen);
    this.root.replaceChildren(
      element('option', { value: '' }, 'choose a dataset'),
      ...names.map((name) => element('option', { value: name }, name)),
      element('option', { value: NEW }, 'a new one ...'));
    this.root.value = chosen;
  }

  private change(): void {
    if (this.root.value !== NEW) {
      this.chosen = this.root.value;
      return this.onChoose(this.chosen);
    }
    this.root.value = this.chosen;
    ask({
      title: 'A new dataset',
      fields: [{ name: 'name', label: 'Name', required: true },
        { name: 'description', label: 'Description' }],
      action: 'Make it',
      run: async ({ name, description }) => {
        await this.api.call('TrainingService/CreateDataset',
          { name: `datasets/${name}`, description });
        await this.read(name!);
        this.onChoose(name!);
      },
    });
  }
}
