// The jobs of a server, the newest first, and the questions that begin one.

import { hrefOf } from '../address';
import type { Api } from '../api';
import { element } from '../dom';
import { Pager } from '../parts/pager';
import { emptyBox, Part } from '../parts/states';
import { button, buttons, link, table, type Cell } from '../parts/table';
import { moment, nameParts, shortName, share, word } from '../parts/texts';
import type { Operation } from '../wire';
import { percent } from '../words';
import { askEvaluate, askTrain } from './questions';

const PAGE = 25;
const FAST_MS = 2000;
const SLOW_MS = 15_000;

export class JobList {
  private readonly part: Part;
  private readonly pager = new Pager(() => this.load());
  private readonly starts: HTMLButtonElement[];

  constructor(private readonly api: Api) {
    this.starts = [button('Train a model ...', () => askTrain(api), 'main'),
      button('Evaluate ...', () => askEvaluate(api, ''))];
    this.part = new Part('Jobs', buttons(...this.starts));
    this.load();
    void api.may('trainer').then((may) => {
      for (const start of this.starts) start.disabled = may === false;
    });
  }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private load(): void {
    void this.part.load(async (signal) => {
      const { operations, next_page_token } = await this.api.call<{
        operations: Operation[]; next_page_token: string; }>(
        'OperationService/ListOperations', { page_size: PAGE,
          page_token: this.pager.token }, signal);
      this.part.later(operations.some(isActive) ? FAST_MS : SLOW_MS,
        () => this.load());
      if (operations.length === 0) {
        return [emptyBox('No job yet', 'Train a model on a dataset, or ' +
          'evaluate one: with the buttons above, or in a shell:',
        'trainctl train --dataset=arm --model=arm ' +
          `--server=${this.api.address}`)];
      }
      return [this.rows(operations), this.pager.view(next_page_token)];
    });
  }

  private rows(operations: Operation[]): HTMLElement {
    return table('Jobs', ['Job', 'What', 'State', 'Result', 'Requested', 'By'],
      operations.map((job): Cell[] => {
        const number = shortName(job.name);
        return [link(hrefOf('train', this.api.server, 'job', number), number),
          purposeOf(job), stateOf(job), this.resultOf(job),
          moment(job.create_time_ms), job.requester];
      }));
  }

  private resultOf(job: Operation): Cell {
    if (job.error?.message) return job.error.message;
    const accuracy = job.result?.evaluation?.accuracy;
    if (accuracy) {
      return `${share(accuracy.correct, accuracy.contacts)} ` +
        `(${accuracy.correct} of ${accuracy.contacts})`;
    }
    const made = job.result?.model_version;
    return made ? link(hrefOf('train', this.api.server, 'model',
      ...nameParts(made)), shortName(made)) : '';
  }
}

export function isActive(job: Operation): boolean {
  return ['STATE_QUEUED', 'STATE_RUNNING', 'STATE_CANCELLING']
    .includes(job.state);
}

// What a job is for: "train arm on arm@2".
export function purposeOf(job: Operation): string {
  if (job.train) {
    return `train ${shortName(job.train.model)} on ` +
      shortName(job.train.dataset_version);
  }
  if (job.evaluate) {
    const { model_version, protocol, dataset_version } = job.evaluate;
    return `evaluate ${model_version ? shortName(model_version) : protocol} ` +
      `on ${shortName(dataset_version)}`;
  }
  if (job.promote) {
    return `promote ${shortName(job.promote.model_version)} to ` +
      shortName(job.promote.alias);
  }
  return word(job.kind);
}

export function stateOf(job: Operation): HTMLElement {
  const text = element('span', { class: 'state' }, word(job.state));
  text.classList.add(`is-${word(job.state)}`);
  if (job.state !== 'STATE_RUNNING' || !job.progress) return text;
  const { fraction, phase } = job.progress;
  const bar = element('progress', { max: '1', value: String(fraction),
    'aria-label': 'progress of the phase' });
  return element('span', { class: 'running' }, text, bar,
    element('span', { class: 'quiet' }, `${percent(fraction)} ${phase}`));
}
