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

export function quantity(value: number, unit: string): string {
  return unit ? `${number(value)} ${unit}` : number(value);
}

export function percent(probability: number): string {
  return `${Math.round(100 * probability)} %`;
}

export function seconds(ns: string | number, digits = 2): string {
  return `${(Number(ns) / 1e9).toFixed(digits)} s`;
}

export function plural(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? '' : 's'}`;
}

// A time since the beginning of a stream, as "12:03.45".
export function clock(time: number): string {
  const hundredths = Math.round(Math.abs(time) * 100);
  const minutes = Math.floor(hundredths / 6000);
  const rest = (hundredths % 6000 / 100).toFixed(2).padStart(5, '0');
  return `${time < 0 ? '-' : ''}${minutes}:${rest}`;
}

// A contact that is felt now.
export type FeltContact = Contact & { patch: Patch };

export function isFelt(contact: Contact): contact is FeltContact {
  return contact.patch !== undefined && contact.patch !== null &&
    !isReleased(contact) && contact.state !== 'STATE_MERGED';
}

// A contact in the answer that ends it.
export function isReleased(contact: Contact): boolean {
  return contact.state === 'STATE_RELEASED';
}

// The server's measure: an event says so when it rises above this.
export function isUnknown(contact: Contact): boolean {
  return contact.unknown > 0.5;
}

// A sign of an event, for marks on curves and the list of events.
const SIGNS: Record<string, string> = {
  KIND_TOUCHED: '●', KIND_RELEASED: '○', KIND_DECIDED: '✓',
  KIND_CHANGED: '⇄', KIND_UNKNOWN: '?', KIND_MERGED: '⊕',
  KIND_SPLIT: '⊖', KIND_MOVED_OVER_SKIN: '→',
};

export function eventSign(event: WatchedEvent): string {
  return SIGNS[event.event.kind] ?? '·';
}

// What happened, in words.
export function eventText(event: WatchedEvent, stream: OpenStream): string {
  const { kind, contact_id: id, question, value, other_id: other } =
    event.event;
  const asked = stream.started.questions[question];
  const answer = asked ? `${asked.name} ${asked.values[value] ?? '?'}` : '?';
  const after = `after ${seconds(event.time_since_onset_ns)}`;
  switch (kind) {
    case 'KIND_TOUCHED': return `contact ${id} touched`;
    case 'KIND_RELEASED': return `contact ${id} released ${after}`;
    case 'KIND_DECIDED': return `contact ${id}: ${answer}, decided ${after}`;
    case 'KIND_CHANGED': return `contact ${id}: now ${answer}, ${after}`;
    case 'KIND_UNKNOWN': return `contact ${id} is unknown, ${after}`;
    case 'KIND_MERGED': return `contact ${id} merged into ${other}`;
    case 'KIND_SPLIT': return `contact ${id} parted from ${other}`;
    case 'KIND_MOVED_OVER_SKIN': return `contact ${id} moves over the skin`;
    default: return `contact ${id}: ${kind}`;
  }
}
