// The train page: jobs, models and aliases; one job, one model, or the history
// of an alias.

import { hrefOf } from '../address';
import { element } from '../dom';
import type { Page, PageContext, PageKind } from '../page';
import { emptyBox } from '../parts/states';
import { link, pageHead } from '../parts/table';
import { AliasHistory } from './alias_history';
import { AliasList } from './alias_list';
import { JobList } from './job_list';
import { JobView } from './job_view';
import { ModelList } from './model_list';
import { ModelView } from './model_view';

export const TRAIN: PageKind = {
  id: 'train',
  title: 'Train',
  ofOneServer: true,
  open: (context) => new TrainPage(context),
};

interface View {
  root: HTMLElement;
  close(): void;
}

class TrainPage implements Page {
  private views: View[] = [];

  constructor(private readonly context: PageContext) {}

  show([kind, name, version]: string[]): void {
    this.close();
    const { api, main } = this.context;
    if (kind === undefined || name === undefined) return this.showAll();
    const view = kind === 'job' ? new JobView(api, name) :
      kind === 'model' ? new ModelView(api, name, version ?? '') :
        kind === 'alias' ? new AliasHistory(api, name) : undefined;
    const back = link(hrefOf('train', api.server), '← Jobs and models');
    if (view === undefined) {
      main.replaceChildren(element('div', { class: 'page' },
        pageHead('Train', back),
        emptyBox('There is no such page', 'The address names none.')));
      return;
    }
    this.views = [view];
    const title = kind === 'job' ? `Job ${name}` :
      kind === 'model' ? `Model ${name}@${version}` : `Alias ${name}`;
    main.replaceChildren(element('div', { class: 'page' },
      pageHead(title, back), view.root));
  }

  close(): void {
    for (const view of this.views) view.close();
    this.views = [];
  }

  private showAll(): void {
    const { api, main } = this.context;
    const aliases = new AliasList(api);
    const models = new ModelList(api, () => aliases.load());
    this.views = [new JobList(api), models, aliases];
    main.replaceChildren(element('div', { class: 'page' }, pageHead('Train'),
      ...this.views.map((view) => view.root)));
  }
}
