// What trainctl says of an import: the trials that it would make, why it makes
// none, and the version that it has made.

import { hrefOf } from '../address';
import type { Api } from '../api';
import { element } from '../dom';
import { bars, facts, link } from '../parts/table';
import { grouped, nameParts, shortName } from '../parts/texts';
import { plural } from '../words';
import type { Answer, ReadResult, SentResult, TrialNote } from
  './import_session';

// Trials that a note names.
const MOST_NAMED = 5;

export function refusal({ error, remarks }: Answer<unknown>): Node[] {
  return [element('div', { class: 'error import-text', role: 'alert' },
    element('p', {}, error!)), ...remarksView(remarks)];
}

export function readView({ result, remarks }: Answer<ReadResult>): Node[] {
  const read = result!;
  const { skin } = read;
  const more: [string, number][] = [['Conditions', read.conditions],
    ['Groups', read.groups], ['Trials with poses', read.with_poses],
    ['Never felt', read.never_felt],
    ['With the frames of an earlier one', read.duplicates]];
  const counts = Object.entries(read.counts).sort(([a], [b]) => a < b ? -1 : 1);
  return [element('div', { class: 'import-result' },
    element('div', {}, element('h3', {}, 'What the import would make'),
      facts(['Trials', grouped(read.trials)], ['Frames', grouped(read.frames)],
        ...(skin ? [['Skin', `${skin.layout}, ${skin.rows} × ` +
          `${skin.columns} taxels`] as [string, string]] : []),
        ...more.filter(([, count]) => count > 0).map(
          ([name, count]): [string, string] => [name, grouped(count)]))),
    element('div', {}, element('h3', {}, 'Labels'), bars(counts))),
  ...remarksView(remarks)];
}

export function sentView(api: Api, { result, remarks }: Answer<SentResult>):
    Node[] {
  const { version, notes } = result!;
  const [dataset, number] = nameParts(version.name);
  const made = element('p', { class: 'done' },
    `Imported ${plural(version.added, 'new trial')}: this is `,
    link(hrefOf('data', api.server, dataset!, number!),
      shortName(version.name)),
    ` now, with ${plural(version.trials, 'trial')}.`);
  return [made, ...notesView(version, notes), ...remarksView(remarks)];
}

// As trainctl datasets upload says it.
function notesView(version: SentResult['version'], notes: TrialNote[]): Node[] {
  const groups: [string, number, string][] = [
    ['duplicate', version.duplicates, 'were there already and were left out'],
    ['replaced', version.relabelled,
      'took the place of trials with the same frames'],
    ['renamed', version.renamed,
      'got another id, because theirs named another recording']];
  return groups.filter(([, count]) => count > 0).map(([kind, count, what]) => {
    const named = notes.filter((note) => note.kind === kind)
      .slice(0, MOST_NAMED).map(noteText);
    if (named.length < count) named.push('...');
    return element('p', {},
      `${grouped(count)} of the trials ${what}: ${named.join(', ')}`);
  });
}

function noteText(note: TrialNote): string {
  const name = note.source || note.id;
  const other = note.other_source || note.other_id;
  if (note.new_id) return `${name} is ${note.new_id}`;
  if (note.label !== note.other_label) {
    return `${name} (${note.label}, was ${note.other_label})`;
  }
  return name === other ? name : `${name} (there as ${other})`;
}

function remarksView(remarks: string[]): Node[] {
  if (remarks.length === 0) return [];
  return [element('div', { class: 'warn import-text' },
    element('h3', {}, 'Remarks'), element('ul', {}, ...remarks.map((text) =>
      element('li', {}, text))))];
}
