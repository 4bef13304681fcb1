// What the console sends: the JSON mapping of tactus.v1.StreamUpdate, as far as
// the page uses it. Integers of 64 bits are text.

export interface Question {
  name: string;
  kind: string;
  values: string[];
}

export interface Geometry {
  layout: string;
  rows: number;
  columns: number;
  row_pitch_m: number;
  column_pitch_m: number;
  unit: string;
  contact_threshold: number;
  masked_taxels: number[];
  // Of something else than touch.
  auxiliary_taxels: number[];
  axes: number;
  normal_axis?: number;
}

export interface OpenStream {
  stream_id: string;
  client_id: string;
  start_time_ms: string;
  sample_rate_hz: number;
  started: {
    model_version: string;
    questions: Question[];
    geometry: Geometry;
  };
}

export interface Counts {
  frames: string;
  frames_missing: string;
  superseded: string;
  contacts: string;
  measured_rate_hz: number;
  silent_ms: string;
}

export interface Decision {
  value: number;
  time_since_onset_ns: string;
  changes: number;
  changed_time_since_onset_ns: string;
}

export interface QuestionAnswer {
  probability: number[];
  decision?: Decision;
}

export interface Patch {
  force: number;
  max_force: number;
  area_taxels: number;
  centroid_row: number;
  centroid_column: number;
  taxels: number[];
}

export interface Contact {
  id: string;
  state: string;
  time_since_onset_ns: string;
  // Absent while the contact is not felt.
  patch?: Patch;
  answers: QuestionAnswer[];
  unknown: number;
}

export interface Frame {
  answer: {
    sequence: string;
    capture_time_ns: string;
    contacts: Contact[];
  };
  age_us: string;
}

export interface WatchedEvent {
  sequence: string;
  capture_time_ns: string;
  time_since_onset_ns: string;
  event: {
    kind: string;
    contact_id: string;
    question: number;
    value: number;
    other_id: string;
  };
}

export interface Update {
  stream_id: string;
  opened?: OpenStream;
  counts?: Counts;
  frame?: Frame;
  events: WatchedEvent[];
  ended: boolean;
}

export interface ServerState {
  address: string;
  state: 'connected' | 'connecting' | 'refused';
  error: string;
}

export interface Message {
  servers: ServerState[];
  updates: { server: number; taxels: number; update: Update }[];
  console_time_ms: number;
  waited_us: number;
}

// A message and the taxels that follow it.
export interface Decoded {
  message: Message;
  taxels: Float32Array;
}

// u32 length, JSON, taxels of single precision; little-endian.
export function decode(bytes: ArrayBuffer): Decoded {
  const length = new DataView(bytes).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(bytes, 4, length));
  const message = JSON.parse(text) as Message;
  for (const { update } of message.updates) complete(update);
  return { message, taxels: new Float32Array(bytes, 4 + length) };
}

// Lists that are empty may be left out of JSON.
function complete(update: Update): void {
  update.events ??= [];
  const { opened, frame } = update;
  if (opened) {
    opened.started.questions ??= [];
    opened.started.geometry.masked_taxels ??= [];
    opened.started.geometry.auxiliary_taxels ??= [];
  }
  if (!frame) return;
  frame.answer.contacts ??= [];
  for (const contact of frame.answer.contacts) {
    contact.answers ??= [];
    if (contact.patch) contact.patch.taxels ??= [];
  }
}
