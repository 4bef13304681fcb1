// One version of a model: where it comes from, and how it did.

import { hrefOf } from '../address';
import { listAll, type Api } from '../api';
import { element } from '../dom';
import { Part } from '../parts/states';
import { button, buttons, facts, link, table, type Cell } from
  '../parts/table';
import { bytes, moment, nameParts, shortName, span } from '../parts/texts';
import type { ModelVersion, Operation } from '../wire';
import { askPromote } from './alias_questions';
import { accuracyText, evaluationView } from './evaluation_view';
import { askEvaluate } from './questions';

export class ModelView {
  readonly root: HTMLElement;
  private readonly origin: Part;
  private readonly results = new Part('Evaluations');
  private readonly newest = element('div');

  constructor(private readonly api: Api, private readonly model: string,
      private readonly version: string) {
    const short = `${model}@${version}`;
    const evaluate = button('Evaluate ...', () => void askEvaluate(api, short));
    const promote = button('Promote ...', () =>
      void askPromote(api, short, () => this.loadOrigin()));
    this.origin = new Part('Origin', buttons(evaluate, promote));
    this.root = element('div', { class: 'stack' }, this.origin.root,
      this.results.root, this.newest);
    this.loadOrigin();
    this.loadResults();
    void api.may('trainer').then((may) => {
      evaluate.disabled = may === false;
    });
    void api.may('admin').then((may) => {
      promote.disabled = may === false;
    });
  }

  close(): void {
    this.origin.close();
    this.results.close();
  }

  private get name(): string {
    return `models/${this.model}/versions/${this.version}`;
  }

  private loadOrigin(): void {
    void this.origin.load(async (signal) => {
      const versions = await listAll<ModelVersion>(this.api,
        'ModelService/ListModelVersions', 'versions', signal);
      const own = versions.find(({ name }) => name === this.name);
      if (own === undefined) {
        return [element('p', {}, 'There is no such version.')];
      }
      return [facts(...this.factsOf(own))];
    });
  }

  private factsOf(own: ModelVersion): [string, Cell][] {
    const { server } = this.api;
    const rows: [string, Cell][] = [
      ['Aliases', own.aliases.map(shortName).join(', ') || 'none'],
      ['Classes', own.class_names.join(', ')],
      ['Skin', own.layout_class || 'any'],
    ];
    if (own.train) {
      const data = own.train.dataset_version;
      rows.push(['Data', link(hrefOf('data', server, ...nameParts(data)),
        shortName(data))], ['Trials', String(own.trials)],
      ['Preset', own.train.preset || 'as the trials asked for'],
      ['Seed', own.train.seed],
      ['Training took', span(own.duration_ms)]);
      if (own.train.note) rows.push(['Note', own.train.note]);
    }
    if (own.operation) {
      const job = shortName(own.operation);
      rows.push(['Job', link(hrefOf('train', server, 'job', job), job)]);
    }
    rows.push(['Size', bytes(own.bytes)],
      ['Made', `${moment(own.create_time_ms)} ` +
        (own.built_in ? '(built in)' : `by ${own.requester}`)]);
    return rows;
  }

  // Of the newest 1,000 jobs. One response cannot hold the reports of all.
  private loadResults(): void {
    void this.results.load(async (signal) => {
      const jobs = await listAll<Operation>(this.api,
        'OperationService/ListOperations', 'operations', signal, 5, 200);
      const own = jobs.filter(({ evaluate, result }) => result?.evaluation &&
        evaluate?.model_version === this.name);
      if (own.length === 0) {
        return [element('p', { class: 'quiet' }, 'It was not evaluated yet.')];
      }
      this.showNewest(own[0]!, jobs);
      return [table('Evaluations, the newest first',
        ['Job', 'Data', 'Accuracy', 'When'], own.map((job): Cell[] => {
          const number = shortName(job.name);
          return [link(hrefOf('train', this.api.server, 'job', number), number),
            shortName(job.evaluate!.dataset_version),
            accuracyText(job.result!.evaluation!.accuracy),
            moment(job.end_time_ms)];
        }))];
    });
  }

  // Beside it, if a person wants, what others did on the same data.
  private showNewest(own: Operation, jobs: Operation[]): void {
    const others = new Map<string, Operation>();
    for (const job of jobs) {
      const name = evaluatedOf(job);
      if (!job.result?.evaluation || name === evaluatedOf(own) ||
          job.evaluate?.dataset_version !== own.evaluate!.dataset_version ||
          others.has(name)) continue;
      others.set(name, job);
    }
    const choice = element('select', { 'aria-label': 'Compare with' },
      element('option', { value: '' }, 'Compare with ...'),
      ...[...others.keys()].map((name) => element('option', {}, name)));
    choice.disabled = others.size === 0;
    const show = () => {
      const other = others.get(choice.value);
      const shown = other ? [own, other] : [own];
      const isFocused = document.activeElement === choice;
      this.newest.replaceChildren(evaluationView(shown.map((job) => ({
        name: other ? evaluatedOf(job) : '',
        report: job.result!.evaluation! })), choice));
      if (isFocused) choice.focus();
    };
    choice.addEventListener('change', show);
    show();
  }
}

// A version, or how the models of a protocol were fitted.
function evaluatedOf({ evaluate }: Operation): string {
  if (!evaluate) return '';
  const { model_version, protocol, train } = evaluate;
  return model_version ? shortName(model_version) :
    [protocol, train?.preset].filter(Boolean).join(', ');
}
