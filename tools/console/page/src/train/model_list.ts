// The versions of all models.

import { hrefOf } from '../address';
import { listAll, type Api } from '../api';
import { emptyBox, Part } from '../parts/states';
import { button, buttons, link, table, type Cell } from '../parts/table';
import { moment, nameParts, shortName } from '../parts/texts';
import type { ModelVersion } from '../wire';
import { askPromote } from './alias_questions';
import { askEvaluate } from './questions';

export class ModelList {
  private readonly part = new Part('Models');

  constructor(private readonly api: Api,
      private readonly onPromoted: () => void) {
    void this.part.load(async (signal) => {
      const versions = await listAll<ModelVersion>(api,
        'ModelService/ListModelVersions', 'versions', signal);
      const [mayTrain, mayPromote] = await Promise.all(
        [api.may('trainer'), api.may('admin')]);
      if (versions.length === 0) {
        return [emptyBox('No model yet', 'Train one.')];
      }
      return [table('Model versions', ['Version', 'Aliases', 'Classes',
        { title: 'Trials', number: true }, 'Preset', 'Made', 'By', ''],
      versions.map((version) =>
        this.row(version, mayTrain !== false, mayPromote !== false)))];
    });
  }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private row(version: ModelVersion, mayTrain: boolean,
      mayPromote: boolean): Cell[] {
    const name = shortName(version.name);
    const evaluate = button('Evaluate ...',
      () => void askEvaluate(this.api, name));
    evaluate.disabled = !mayTrain;
    const promote = button('Promote ...',
      () => void askPromote(this.api, name, this.onPromoted));
    promote.disabled = !mayPromote;
    for (const tool of [evaluate, promote]) {
      tool.setAttribute('aria-label', `${tool.textContent} ${name}`);
    }
    return [link(hrefOf('train', this.api.server, 'model',
      ...nameParts(version.name)), name),
    version.aliases.map(shortName).join(', '),
    version.class_names.join(', '),
    version.trials > 0 ? String(version.trials) : '–',
    version.built_in ? 'built in' : version.train?.preset ?? 'imported',
    moment(version.create_time_ms), version.requester,
    buttons(evaluate, promote)];
  }
}
