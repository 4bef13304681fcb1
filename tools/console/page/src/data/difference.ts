// What differs between two versions of a dataset, in counts.

import { element } from '../dom';
import { facts, table } from '../parts/table';
import { nameParts, signed } from '../parts/texts';
import type { DatasetVersion } from '../wire';

// `version` against one that can be chosen: at first the one before it.
export function differenceView(all: DatasetVersion[],
    version: DatasetVersion): HTMLElement {
  const others = all.filter((other) => other !== version);
  const at = all.indexOf(version);
  const choice = element('select', { 'aria-label': 'Compare with version' },
    ...others.map((other, i) =>
      element('option', { value: String(i) }, `@${nameParts(other.name)[1]}`)));
  choice.value = String(Math.max(0, Math.min(at - 1, others.length - 1)));
  const result = element('div');
  const show = () => {
    const other = others[Number(choice.value)];
    if (other) result.replaceChildren(...compare(all, other, version));
  };
  choice.addEventListener('change', show);
  show();
  return element('div', {}, element('p', { class: 'choose' },
    `From version `, choice, ` to @${nameParts(version.name)[1]}`), result);
}

function compare(all: DatasetVersion[], from: DatasetVersion,
    to: DatasetVersion): Node[] {
  const labels = [...new Set([...Object.keys(from.labels),
    ...Object.keys(to.labels)])].sort();
  const rows = labels.map((label) => {
    const before = from.labels[label] ?? 0;
    const after = to.labels[label] ?? 0;
    return [label || '(no label)', String(before), String(after),
      signed(after - before)];
  });
  rows.push(['all', String(from.trials), String(to.trials),
    signed(to.trials - from.trials)]);
  const count = (title: string) => ({ title, number: true });
  const counts = table('Trials of each label', ['Label',
    count(`@${nameParts(from.name)[1]}`), count(`@${nameParts(to.name)[1]}`),
    count('Change')], rows);
  // A version counts only what it changed of the one before.
  if (all.indexOf(to) !== all.indexOf(from) + 1) return [counts];
  return [counts, facts(
    ['New', String(to.added - to.relabelled)],
    ['Gone', String(to.removed - to.relabelled)],
    ['Relabelled', String(to.relabelled)])];
}
