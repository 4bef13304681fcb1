// The fields that choose which contacts are listed.

import { element, setText } from '../dom';
import { button } from '../parts/table';
import type { Logged } from './messages';
import { FLAGS, isFiltered, noFilters, type Filters, type Flag } from
  './filters';

// What is suggested beside what was seen so far.
export interface Suggestions {
  // Like "arm@3".
  versions: string[];
  classes: string[];
}

const TITLES: Record<Flag, string> = {
  unknown: 'Unknown', undecided: 'Undecided', revised: 'Revised',
  disagreeing: 'Shadow disagrees',
};

export class FilterBar {
  readonly root: HTMLElement;
  private readonly robot = field('Robot', 'text');
  private readonly model = choice('Model', [['', 'all models']]);
  private readonly answer = field('Answer', 'text');
  private readonly below = field('Confidence below, %', 'number');
  private readonly labelled = choice('Labels', [['', 'with and without'],
    ['no', 'without a label'], ['yes', 'with a label']]);
  private readonly order = choice('Order', [['', 'newest first'],
    ['uncertain', 'most uncertain first']]);
  private readonly flags = new Map(FLAGS.map((flag) =>
    [flag, this.makeFlag(flag)]));
  private readonly clear = button('Clear', () => this.onChange(noFilters()));
  private readonly robots = new Set<string>();
  private readonly answers = new Set<string>();
  private filters = noFilters();

  constructor(private readonly onChange: (filters: Filters) => void) {
    this.below.input.min = '1';
    this.below.input.max = '100';
    this.answer.input.placeholder = 'SM, mobility=moved';
    this.root = element('div', { class: 'filters', role: 'group',
      'aria-label': 'Which contacts are listed' },
    this.order.root, this.labelled.root, this.robot.root, this.model.root,
    this.answer.root, this.below.root,
    element('div', { class: 'flags' }, ...this.flags.values(), this.clear));
    for (const { input } of this.inputs) {
      input.addEventListener('change', () => this.read());
    }
  }

  show(filters: Filters): void {
    this.filters = filters;
    this.addModel(filters.model);
    for (const [name, { input }] of this.named) input.value = filters[name];
    for (const [flag, tool] of this.flags) {
      tool.setAttribute('aria-pressed', String(filters.flags.includes(flag)));
    }
    this.clear.hidden = !isFiltered(filters);
  }

  suggest({ versions, classes }: Suggestions): void {
    const models = [...new Set(versions.map((name) => name.split('@')[0]!))];
    for (const name of models) {
      const own = versions.filter((version) => version.startsWith(`${name}@`));
      for (const version of [name, ...own]) this.addModel(version);
    }
    for (const name of classes) this.answers.add(name);
    this.suggestTexts();
  }

  // What the listed contacts have can be asked for.
  note(contacts: Logged[]): void {
    for (const { robot, label, answers } of contacts) {
      if (robot) this.robots.add(robot);
      if (label) this.answers.add(label);
      for (const { question, value } of answers) {
        this.answers.add(`${question}=${value}`);
      }
    }
    this.suggestTexts();
  }

  private get named() {
    return [['robot', this.robot], ['model', this.model],
      ['answer', this.answer], ['below', this.below],
      ['labelled', this.labelled], ['order', this.order]] as const;
  }

  private get inputs() { return this.named.map(([, made]) => made); }

  private read(): void {
    const filters = { ...this.filters };
    for (const [name, { input }] of this.named) {
      filters[name] = input.value.trim();
    }
    this.onChange(filters);
  }

  private makeFlag(flag: Flag): HTMLButtonElement {
    return button(TITLES[flag], () => {
      const { flags } = this.filters;
      this.onChange({ ...this.filters, flags: flags.includes(flag) ?
        flags.filter((other) => other !== flag) : [...flags, flag] });
    });
  }

  private addModel(name: string): void {
    const { input } = this.model;
    if ([...input.options].some(({ value }) => value === name)) return;
    const option = element('option', { value: name });
    setText(option, name.includes('@') ? name : `${name}, all versions`);
    input.append(option);
  }

  private suggestTexts(): void {
    fill(this.robot.list, [...this.robots].sort());
    fill(this.answer.list, [...this.answers]);
  }
}

let ids = 0;

function field(title: string, type: string) {
  const id = `filter-${++ids}`;
  const list = element('datalist', { id: `${id}-list` });
  const input = element('input', { id, type, autocomplete: 'off',
    list: list.id });
  return { input, list, root: element('div', { class: 'filter' },
    element('label', { for: id }, title), input, list) };
}

function choice(title: string, options: [string, string][]) {
  const id = `filter-${++ids}`;
  const input = element('select', { id }, ...options.map(([value, text]) =>
    element('option', { value }, text)));
  return { input, root: element('div', { class: 'filter' },
    element('label', { for: id }, title), input) };
}

function fill(list: HTMLElement, values: string[]): void {
  if (list.children.length === values.length) return;
  list.replaceChildren(...values.map((value) => element('option', { value })));
}
