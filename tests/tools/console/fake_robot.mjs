// Made-up robots: skins with moving contacts, their answers, and events, frame
// by frame. The same frame number gives the same frame.

const FRAMES_PER_S = 30;
// A contact comes every so many frames, and lasts for some of them.
const PERIOD = 6 * FRAMES_PER_S;
const ONSET = FRAMES_PER_S / 2;
const DECIDED = ONSET + 8;
const SLIP = ONSET + 2 * FRAMES_PER_S;
const RELEASE = ONSET + 5 * FRAMES_PER_S;

const HARDNESS = { name: 'hardness', kind: 'KIND_PROPERTY',
  values: ['hard', 'soft'], value_of_class: [0, 0, 1, 1] };
const MOBILITY = { name: 'mobility', kind: 'KIND_STATE',
  values: ['unmoved', 'moved'], value_of_class: [0, 1, 0, 1] };

// `traits`: what is special about it; see the fields below.
export class FakeRobot {
  constructor(id, name, traits = {}) {
    this.id = String(id);
    this.name = name;
    this.rows = traits.rows ?? 16;
    this.columns = traits.columns ?? 24;
    this.axes = traits.axes ?? 1;
    this.masked = traits.masked ?? [];
    this.unknown = traits.unknown ?? false;
    this.contacts = traits.contacts ?? 1;
    this.questions = traits.questions ?? [HARDNESS, MOBILITY];
    this.missing = traits.missing ?? 0;
    this.startMs = Date.now() - 65_000;
    this.number = 0;
    this.silent = false;
    this.ended = false;
    // Sends the same frame again and again.
    this.isStill = false;
    this.events = [];
    this.silentSince = Date.now();
    // Robots are not in step.
    this.phase = 37 * Number(id);
  }

  // Goes on by a frame.
  step() {
    if (this.silent || this.ended) return;
    ++this.number;
    this.silentSince = Date.now();
    if (this.isStill) return;
    const at = (this.number + this.phase) % PERIOD;
    for (const contact of this.touching()) this.addEvents(contact, at);
    this.frame = this.makeFrame(at);
  }

  opened() {
    return {
      stream_id: this.id, client_id: this.name, caller: 'fake', peer: 'fake',
      start_time_ms: String(this.startMs), sample_rate_hz: 100,
      started: {
        model_version: 'models/default/versions/1',
        class_names: ['HU', 'HM', 'SU', 'SM'], questions: this.questions,
        geometry: {
          layout: 'fake', rows: this.rows, columns: this.columns,
          row_pitch_m: 0.0108, column_pitch_m: 0.0108,
          taxel_area_m2: 1e-4, wrap_columns: false,
          unit: this.axes === 3 ? 'TAXEL_UNIT_COUNTS' : 'TAXEL_UNIT_NEWTON',
          contact_threshold: 0.01, onset_threshold: 0.02,
          masked_taxels: this.masked, auxiliary_taxels: [],
          connectivity: 'CONNECTIVITY_8',
          axes: this.axes, signed_values: this.axes === 3,
          ...(this.axes === 3 ? { normal_axis: 2 } : {}),
        },
      },
      counts: this.counts(),
    };
  }

  counts() {
    return {
      frames: String(this.number), frames_missing: String(this.missing),
      superseded: '0', contacts: '3', contacts_now: 1,
      measured_rate_hz: this.number > 0 ? 99.8 : 0,
      silent_ms: String(Date.now() - this.silentSince),
    };
  }

  captureNs(number = this.number) {
    return String(BigInt(Math.round(1e15 + number * 1e9 / FRAMES_PER_S)));
  }

  // The numbers of the contacts that touch or have just ended.
  touching() {
    const round = Math.floor((this.number + this.phase) / PERIOD);
    return Array.from({ length: this.contacts }, (_, i) =>
      round * this.contacts + i + 1);
  }

  addEvents(id, at) {
    const add = (kind, question = 0, value = 0) => this.events.push({
      sequence: String(this.number), capture_time_ns: this.captureNs(),
      time_since_onset_ns: String((at - ONSET) * 1e9 / FRAMES_PER_S),
      event: { kind, contact_id: String(id), question, value, other_id: '0' },
    });
    if (at === ONSET) add('KIND_TOUCHED');
    if (at === RELEASE) add('KIND_RELEASED');
    if (this.unknown) {
      if (at === DECIDED) add('KIND_UNKNOWN');
      return;
    }
    if (at === DECIDED) {
      this.questions.forEach((_, q) => add('KIND_DECIDED', q, 0));
    }
    const state = this.questions.findIndex((q) => q.kind === 'KIND_STATE');
    if (at === SLIP && state >= 0) add('KIND_CHANGED', state, 1);
  }

  makeFrame(at) {
    const taxels = this.background();
    const touches = at >= ONSET && at < RELEASE;
    const contacts = touches ? this.touching().map((id, i) =>
      this.makeContact(id, i, at, taxels)) : [];
    return {
      json: { answer: { sequence: String(this.number),
        capture_time_ns: this.captureNs(), contacts, events: [],
        region_count: contacts.length, frames_missing: '0', superseded: '0',
        is_final: false },
      taxels: '', age_us: '900' },
      taxels,
    };
  }

  background() {
    const taxels = new Float32Array(this.rows * this.columns * this.axes);
    for (let i = 0; i < taxels.length; ++i) {
      taxels[i] = 0.004 * ((i * 7919 + this.number * 104729) % 97) / 97;
    }
    return taxels;
  }

  // Presses on the skin and says what is touched.
  makeContact(id, place, at, taxels) {
    const since = (at - ONSET) / FRAMES_PER_S;
    const press = Math.min(1, since / 0.8) * (place === 0 ? 1.4 : 0.5);
    const radius = (place === 0 ? 0.16 : 0.09) *
      Math.min(this.rows, this.columns) + 0.8;
    const row = this.rows * (0.3 + 0.4 * place) +
      0.1 * this.rows * Math.sin(since);
    const column = this.columns * (0.25 + 0.45 * place) +
      0.08 * this.columns * Math.max(0, since - 2);
    const patch = { force: 0, max_force: 0, area_taxels: 0, area_m2: 0,
      centroid_row: row, centroid_column: column, taxels: [] };
    for (let i = 0; i < this.rows * this.columns; ++i) {
      const down = Math.floor(i / this.columns) - row;
      const right = i % this.columns - column;
      const load = press * Math.exp(-(down ** 2 + right ** 2) / radius ** 2);
      if (load < 0.05 || this.masked.includes(i)) continue;
      this.setTaxel(taxels, i, load, down, right);
      patch.force += load;
      patch.max_force = Math.max(patch.max_force, load);
      patch.taxels.push(i);
    }
    patch.area_taxels = patch.taxels.length;
    return {
      id: String(id), state: 'STATE_TOUCHING', onset_sequence: '1',
      time_since_onset_ns: String(Math.round(since * 1e9)), patch,
      probability: [0.25, 0.25, 0.25, 0.25],
      answers: this.questions.map((question) => this.answer(question, at)),
      unknown: this.unknown ? 0.97 : 0.02,
      parent_id: '0', merged_into: '0', motion_m: 0,
    };
  }

  setTaxel(taxels, i, load, down, right) {
    if (this.axes === 1) {
      taxels[i] = load;
      return;
    }
    taxels[3 * i] = 0.25 * load * down;
    taxels[3 * i + 1] = 0.25 * load * right + 0.3 * load;
    taxels[3 * i + 2] = load;
  }

  // The first value, ever more sure; a state changes to its second value.
  answer(question, at) {
    const changed = question.kind === 'KIND_STATE' && at >= SLIP;
    const since = (at - (changed ? SLIP : ONSET)) / FRAMES_PER_S;
    const count = question.values.length;
    const sure = this.unknown ? 0.55 :
      1 / count + (1 - 1 / count) * (1 - Math.exp(-4 * since)) * 0.995;
    const value = changed ? 1 : 0;
    const probability = question.values.map((_, v) =>
      v === value ? sure : (1 - sure) / (count - 1));
    const decided = at >= DECIDED && !this.unknown;
    return { probability, ...(decided ? { decision: { value,
      sequence: '20', time_since_onset_ns: '266666667',
      changes: changed ? 1 : 0, changed_sequence: '0',
      changed_time_since_onset_ns: '0', revised: false } } : {}) };
  }
}

// A usual group: with two contacts, unknown objects, three axes, other shapes,
// and a question with many values among them.
export function makeRobots(count) {
  return Array.from({ length: count }, (_, i) => {
    const name = `arm-${i + 1}`;
    switch (i % 7) {
      case 1: return new FakeRobot(i + 1, name, { contacts: 2, missing: 12 });
      case 2: return new FakeRobot(i + 1, name, { rows: 6, columns: 10,
        unknown: true });
      case 3: return new FakeRobot(i + 1, name, { rows: 8, columns: 8,
        axes: 3 });
      case 5: return new FakeRobot(i + 1, name, { rows: 32, columns: 12,
        masked: [100, 101, 113, 250] });
      case 6: return new FakeRobot(i + 1, name, { questions: [
        { name: 'class', kind: 'KIND_PROPERTY', value_of_class: [],
          values: ['mug', 'bowl', 'sponge', 'book', 'bottle', 'cable'] }] });
      default: return new FakeRobot(i + 1, name);
    }
  });
}
