// Messages of the contact log, as far as the page uses them:
// proto/tactus/v1/contact_log.proto says what each field means. Integers of 64
// bits are text.

import type { Contact, OpenStream, WatchedEvent } from '../messages';

export interface LoggedAnswer {
  question: string;
  value: string;
  probability: number;
  decided: boolean;
  revised: boolean;
}

export interface Picture {
  rows: number;
  columns: number;
  // Bytes in base64.
  loads: string;
  most: number;
}

export interface Given {
  label: string;
  labelling?: { by: string; time_ms: string; prefilled: boolean } | null;
  dataset_version: string;
}

export interface Logged {
  name: string;
  robot: string;
  caller: string;
  model_version: string;
  layout: string;
  begin_time_ms: string;
  duration_ns: string;
  onset_sequence: string;
  end_sequence: string;
  label: string;
  confidence: number;
  unknown: number;
  answers: LoggedAnswer[];
  max_force: number;
  together: number;
  cut: boolean;
  exact: boolean;
  given?: Given | null;
  shadow?: { model_version: string; label: string; confidence: number } | null;
  picture?: Picture | null;
}

export interface ContactList {
  contacts: Logged[];
  next_page_token: string;
  matching: number;
  kept: number;
  left_out: string;
  bytes: string;
  max_bytes: string;
}

export interface ReplayedFrame {
  answer: {
    sequence: string;
    capture_time_ns: string;
    contacts: Contact[];
    events: WatchedEvent['event'][];
  };
  // Single precision in base64.
  taxels: string;
}

export interface Replayed {
  contact: Logged;
  started: OpenStream['started'] & { class_names: string[] };
  frames: ReplayedFrame[];
  contact_id: string;
  same_answers: boolean;
  replayed?: Logged | null;
}

export interface ContactLabel {
  contact: string;
  label: string;
  object?: string;
  condition?: string;
  material?: string;
  prefilled: boolean;
}
