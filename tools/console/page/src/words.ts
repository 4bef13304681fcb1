// Texts of the page.

import type { Contact, Geometry, OpenStream, Patch, WatchedEvent } from
  './messages';

const UNITS: Record<string, string> = {
  TAXEL_UNIT_NEWTON: 'N', TAXEL_UNIT_COUNTS: 'counts',
};

export function unitOf(geometry: Geometry): string {
  return UNITS[geometry.unit] ?? '';
}

// "models/default/versions/1" as "default@1".
export function modelOf(stream: OpenStream): string {
  return stream.started.model_version
    .replace(/^models\//, '').replace('/versions/', '@');
}

export function number(value: number): string {
  return Number(value.toPrecision(3)).toString();
}

export function percent(probability: number): string {
  return `${Math.round(100 * probability)} %`;
}

export function seconds(ns: string | number): string {
  return `${(Number(ns) / 1e9).toFixed(2)} s`;
}

// A contact that is felt now.
export type FeltContact = Contact & { patch: Patch };

export function isFelt(contact: Contact): contact is FeltContact {
  return contact.patch !== undefined && contact.patch !== null &&
    contact.state !== 'STATE_RELEASED' && contact.state !== 'STATE_MERGED';
}

// What happened, in words.
export function eventText(event: WatchedEvent, stream: OpenStream): string {
  const { kind, contact_id: id, question, value, other_id: other } =
    event.event;
  const asked = stream.started.questions[question];
  const answer = asked ? `${asked.name}: ${asked.values[value] ?? '?'}` : '?';
  const after = ` after ${seconds(event.time_since_onset_ns)}`;
  switch (kind) {
    case 'KIND_TOUCHED': return `contact ${id} touched`;
    case 'KIND_RELEASED': return `contact ${id} released${after}`;
    case 'KIND_DECIDED': return `contact ${id} decided ${answer}${after}`;
    case 'KIND_CHANGED': return `contact ${id} changed to ${answer}${after}`;
    case 'KIND_UNKNOWN': return `contact ${id} is unknown${after}`;
    case 'KIND_MERGED': return `contact ${id} merged into ${other}`;
    case 'KIND_SPLIT': return `contact ${id} split off ${other}`;
    case 'KIND_MOVED_OVER_SKIN': return `contact ${id} moves over the skin`;
    default: return `contact ${id}: ${kind}`;
  }
}
