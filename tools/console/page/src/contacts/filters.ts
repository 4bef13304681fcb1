// What the list of contacts shows, as it stands in the address:
// "#contacts@1/17/robot=arm-1/order=uncertain" has contact 17 open, and lists
// the contacts of arm-1, the least confident first.

import { hrefOf } from '../address';
import { fullName } from '../parts/texts';

export const FLAGS =
  ['unknown', 'undecided', 'revised', 'disagreeing'] as const;
export type Flag = typeof FLAGS[number];

export interface Filters {
  robot: string;
  // Like "arm" or "arm@3".
  model: string;
  answer: string;
  // In percent.
  below: string;
  // "yes", "no", or empty for both.
  labelled: string;
  // "uncertain", or empty for the newest first.
  order: string;
  flags: Flag[];
}

const TEXTS = ['robot', 'model', 'answer', 'below', 'labelled', 'order'] as
  const;

export function noFilters(): Filters {
  return { robot: '', model: '', answer: '', below: '', labelled: '',
    order: '', flags: [] };
}

// `open`: the number of the contact that the address names.
export function filtersOf(path: string[]): { open?: string;
  filters: Filters } {
  const filters = noFilters();
  let open: string | undefined;
  for (const part of path) {
    const at = part.indexOf('=');
    const name = at < 0 ? part : part.slice(0, at);
    const text = TEXTS.find((known) => known === name);
    const flag = FLAGS.find((known) => known === name);
    if (at < 0 && /^\d+(-\d+)?$/.test(part)) open = part;
    else if (text && at > 0) filters[text] = part.slice(at + 1);
    else if (flag && !filters.flags.includes(flag)) filters.flags.push(flag);
  }
  return { open, filters };
}

export function addressOfFilters(server: number, filters: Filters,
    open?: string): string {
  return [hrefOf('contacts', server), ...(open ? [open] : []),
    ...TEXTS.filter((name) => filters[name] !== '').map((name) =>
      `${name}=${encodeURIComponent(filters[name])}`),
    ...filters.flags].join('/');
}

export function isFiltered(filters: Filters): boolean {
  return filters.flags.length > 0 || TEXTS.some((name) =>
    name !== 'order' && filters[name] !== '');
}

// The fields of a ListContactsRequest.
export function requestOf(filters: Filters): Record<string, unknown> {
  const { robot, model, answer, below, labelled, order, flags } = filters;
  const most = Number(below) / 100;
  return {
    ...(robot ? { robot } : {}), ...(answer ? { answer } : {}),
    ...(model ? { model: fullName('models', model) } : {}),
    ...(most > 0 ? { confidence_below: most } : {}),
    ...(labelled ? { labelled: labelled === 'yes' } : {}),
    ...(order === 'uncertain' ? { order: 'ORDER_UNCERTAIN' } : {}),
    ...Object.fromEntries(flags.map((flag) => [`only_${flag}`, true])),
  };
}
