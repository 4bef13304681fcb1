// What a made-up server answers to the pages beside the live one: always the
// same, with clocks that stand still.

import { FakeRobot } from './fake_robot.mjs';

export const NOW_MS = Date.UTC(2026, 3, 14, 9, 26);
const DAY_MS = 86_400_000;
const CLASSES = ['HU', 'HM', 'SU', 'SM'];
const TIMES = [0.1, 0.25, 0.5, 1.2, 2.5, 5];

// Wilson's 95 % interval (JASA 22, 1927).
export function accuracyOf(correct, contacts) {
  const z = 1.959964;
  const p = correct / contacts;
  const middle = (p + z * z / (2 * contacts)) / (1 + z * z / contacts);
  const half = z * Math.sqrt(p * (1 - p) / contacts +
    z * z / (4 * contacts * contacts)) / (1 + z * z / contacts);
  return { correct, contacts, low: middle - half, high: middle + half };
}

// Of 200 contacts, `wrong` are wrong in the end.
export function evaluationOf(wrong, changes = {}) {
  const right = 200 - wrong;
  const anytime = (end) => TIMES.map((_, t) =>
    accuracyOf(Math.round(end - (5 - t) * (5 - t) * 3.2), 200));
  const bins = [[6, 4, 3], [8, 12, 8], [10, 20, 14], [12, 44, 37],
    [14, 120, right - 72]];
  return {
    accuracy: accuracyOf(right, 200), never_felt: 3,
    log_loss: 0.01 * wrong + 0.08, calibration_error: 0.0312,
    class_names: CLASSES,
    confusion: [46, 4, 0, 0, 3, 47, 0, 0, 0, wrong - 10, 60 - wrong, 0, 0, 0,
      3, 47],
    anytime_s: TIMES, anytime: anytime(right),
    trained_on_data: false, trained_on_contacts: 0, wrong: [
      { name: 'cork-07.csv', label: 'SU', answer: 'SM' }],
    questions: [['hardness', 198], ['mobility', right + 4]].map(
      ([name, end]) => ({ name, accuracy: accuracyOf(end, 200),
        anytime: anytime(end) })),
    reliability: bins.map(([bin, contacts, correct]) => ({ low: bin / 15,
      high: (bin + 1) / 15, confidence: (bin + 0.6) / 15,
      accuracy: accuracyOf(correct, contacts) })),
    ...changes,
  };
}

function jobOf(number, kind, more) {
  const end = NOW_MS - (9 - number) * DAY_MS;
  return { name: `operations/${number}`, kind: `KIND_${kind}`,
    state: 'STATE_SUCCEEDED', create_time_ms: String(end - 95_000),
    start_time_ms: String(end - 94_000), end_time_ms: String(end),
    attempts: 1, requester: 'ann', request_id: '', progress: null, error: null, ...more };
}

const trainSpec = (model, preset) => ({ dataset_version:
  'datasets/arm/versions/3', model: `models/${model}`, preset, note: '',
seed: '1' });

export function jobsOf({ old = false } = {}) {
  const evaluation = (number, model_version, wrong, changes) =>
    jobOf(number, 'EVALUATE', {
      evaluate: { dataset_version: 'datasets/arm/versions/3', model_version,
        protocol: '', train: null },
      result: { model_version: '', evaluation: evaluationOf(wrong, changes),
        comparison: null, unusable: 0, duplicates: 0, preset_choice: null } });
  return [
    jobOf(9, 'PROMOTE', { promote: { alias: 'aliases/default',
      model_version: 'models/arm/versions/2', force: false },
    result: { model_version: '', evaluation: null, comparison: {
      current: evaluationOf(28), candidate: evaluationOf(14), only_current: 2,
      only_candidate: 16, mcnemar_p: 0.0013, passed: true, failure: '' },
    unusable: 0, duplicates: 0, preset_choice: null } }),
    evaluation(8, 'models/arm/versions/2', 14, old ?
      { questions: [], reliability: [] } : {}),
    evaluation(7, 'models/arm/versions/1', 28),
    jobOf(6, 'EVALUATE', { evaluate: {
      dataset_version: 'datasets/arm/versions/3', model_version: '',
      protocol: 'k-fold', train: trainSpec('', 'ridge') },
    result: { model_version: '', evaluation: evaluationOf(31),
      comparison: null, unusable: 0, duplicates: 0, preset_choice: null } }),
    jobOf(5, 'TRAIN', { request_id: 'nightly-17',
      train: trainSpec('arm', 'tuned'), result: {
      model_version: 'models/arm/versions/2', evaluation: null,
      comparison: null, unusable: 0, duplicates: 0, preset_choice: null } }),
  ];
}

export function modelsOf() {
  const model = (name, more) => ({ name, bytes: '1843200', create_time_ms:
    String(NOW_MS - 4 * DAY_MS), class_names: CLASSES, layout_class: 'allegro',
  built_in: false, operation: 'operations/5', train: trainSpec('arm', 'tuned'),
  trials: 240, duration_ms: '94000', aliases: [], requester: 'ann', ...more });
  return [model('models/arm/versions/2', {}),
    model('models/arm/versions/1', { aliases: ['aliases/default'],
      create_time_ms: String(NOW_MS - 9 * DAY_MS) }),
    model('models/default/versions/1', { built_in: true, train: null,
      operation: '', trials: 0, layout_class: '' })];
}

// Answers of the RPCs that the pages for training call, for FakeConsole.
export function trainAnswers(options) {
  const jobs = jobsOf(options);
  const page = (items) => ({ ...items, next_page_token: '' });
  const answers = {
    'AdminService/GetServerInfo': () => ({}),
    'ModelService/ListModelVersions': () => page({ versions: modelsOf() }),
    'ModelService/ListAliases': () => page({ aliases: [
      { name: 'aliases/default', model_version: 'models/arm/versions/1',
        etag: 'e1', canary: { model_version: 'models/arm/versions/2',
          per_mille: 50 }, gate: null,
        previous_version: 'models/default/versions/1' }] }),
    'OperationService/ListOperations': () => page({ operations: jobs }),
    'OperationService/WatchOperation': (body) => ({ points: [],
      operation: jobs.find(({ name }) => name === JSON.parse(body).name) }),
    'OperationService/ReadOperationLog': () => ({ messages: [] }),
  };
  return Object.fromEntries(Object.entries(answers).map(([name, answer]) =>
    [`/api/servers/0/${name}`, answer]));
}

const replicaOf = (host, more) => ({ name: `replicas/${host}`, host,
  address: `${host}:50051`, version: '0.2.0',
  start_time_ms: String(NOW_MS - 3 * DAY_MS), is_this: false, alive: true,
  up_to_date: true, ...more });

// Answers for the page of the server. `changes`: of GetServerInfo.
export function serverAnswers({ status = 'SERVING', changes = {} } = {}) {
  const stream = (id, client_id, caller) => ({ stream_id: id, client_id, caller,
    peer: `ipv4:10.0.0.${id}:40000`, start_time_ms: String(NOW_MS - 3_600_000),
    started: { model_version: 'models/arm/versions/1' }, sample_rate_hz: 100,
    counts: { frames: '360000', frames_missing: '12', superseded: '0',
      contacts: '418', contacts_now: 1, measured_rate_hz: 99.7,
      silent_ms: '4' } });
  const page = (items) => ({ ...items, next_page_token: '' });
  const answers = {
    'Health/Check': () => ({ status }),
    'AdminService/GetServerInfo': () => ({
      version: { version: '0.2.0', api: 'tactus.v1' },
      start_time_ms: String(NOW_MS - 3 * DAY_MS), time_ms: String(NOW_MS),
      uptime_ms: String(3 * DAY_MS), streams: 2, max_streams: 64,
      data: { folder: '/var/lib/tactus', blob_bytes: '734003200',
        upload_bytes: '0', job_bytes: '1048576', catalog_bytes: '524288',
        free_bytes: '53687091200' },
      jobs: [{ state: 'STATE_QUEUED', count: 1 },
        { state: 'STATE_SUCCEEDED', count: 5 }],
      quotas: { stored_bytes: '0', datasets: '10', queued_jobs: '4',
        streams: '8', model_bytes: '67108864' },
      not_served: [], replicas: [], caller: 'ann', ...changes }),
    'AdminService/ListAuditLog': () => page({ entries: [
      { time_ms: String(NOW_MS - DAY_MS), caller: 'ann',
        peer: 'ipv4:10.0.0.9:51000', verb: 'create',
        resource: 'datasets/arm/versions/3', reason: '' }] }),
    'MonitorService/ListStreams': () => page({ streams: [
      stream('1', 'left arm', 'robots'), stream('2', 'right arm', 'robots')] }),
    'ModelService/ListModelVersions': () => page({ versions: modelsOf() }),
    'OperationService/ListOperations': () => page({ operations: [
      { requester: 'bob' }] }),
    'TrainingService/ListDatasets': () => page({ datasets: [
      { name: 'datasets/arm', requester: 'ann' },
      { name: 'datasets/gripper', requester: 'ann' }] }),
  };
  return Object.fromEntries(Object.entries(answers).map(([name, answer]) =>
    [`/api/servers/0/${name}`, answer]));
}

// What is wrong with a server that is degraded.
export const DEGRADED = { streams: 64,
  not_served: ['models/old/versions/1: BUNDLE_VERSION'],
  replicas: [replicaOf('lab-1', { is_this: true }),
    replicaOf('lab-2', { alive: false }),
    replicaOf('lab-3', { up_to_date: false }),
    replicaOf('worker-1', { address: '' })] };

// Answers for the pages of contacts and of data.
export function dataAnswers() {
  const page = (items) => ({ ...items, next_page_token: '' });
  const labels = { HU: 62, HM: 60, SU: 58, SM: 60 };
  const version = (number, more) => ({
    name: `datasets/arm/versions/${number}`, trials: 240, bytes: '52428800',
    create_time_ms: String(NOW_MS - (12 - number) * DAY_MS), labels, added: 0,
    removed: 0, requester: 'ann', change: 'CHANGE_UPLOAD', reason: '',
    relabelled: 0, duplicates: 0, renamed: 0, ...more });
  const trials = Array.from({ length: 12 }, (_, i) => ({ sha256: '0'.repeat(64),
    id: String(i).padStart(6, '0'), label: CLASSES[i % 4], condition: `c${i % 3}`,
    object: 'block', material: ['cork', 'glass', 'foam'][i % 3],
    layout: 'allegro', frames: 500, source: `run-${i}.csv` }));
  const answers = {
    'AdminService/GetServerInfo': () => ({}),
    'ContactLogService/ListContacts': () => page({
      contacts: [1, 2, 3, 4].map(contactOf), matching: 4, kept: 4,
      left_out: '0', bytes: '3145728', max_bytes: '1073741824' }),
    'ContactLogService/ReplayContact': replayOf,
    'ModelService/ListModelVersions': () => page({ versions: modelsOf() }),
    'TrainingService/ListDatasets': () => page({ datasets: [
      { name: 'datasets/arm', description: 'the left arm', latest_version: 3,
        create_time_ms: String(NOW_MS - 11 * DAY_MS), requester: 'ann' }] }),
    'TrainingService/GetDataset': () => ({
      dataset: { name: 'datasets/arm', description: 'the left arm',
        create_time_ms: String(NOW_MS - 11 * DAY_MS), latest_version: 3,
        requester: 'ann' },
      versions: [version(1, { added: 240 }),
        version(2, { change: 'CHANGE_RELABEL', relabelled: 4,
          reason: 'it moved' }), version(3, { added: 12, duplicates: 3 })] }),
    'TrainingService/ListTrials': () => page({ trials }),
  };
  return Object.fromEntries(Object.entries(answers).map(([name, answer]) =>
    [`/api/servers/0/${name}`, answer]));
}

// The frames of the first contact, by a made-up robot.
function replayOf() {
  const robot = new FakeRobot(0, 'left arm');
  const frames = [];
  while (frames.length < 60) {
    robot.step();
    const { json: { answer }, taxels } = robot.frame;
    if (answer.contacts.length === 0) continue;
    frames.push({ answer,
      taxels: Buffer.from(taxels.buffer).toString('base64') });
  }
  return { contact: contactOf(1), frames,
    started: { ...robot.opened().started, class_names: CLASSES },
    contact_id: frames[0].answer.contacts[0].id, same_answers: true,
    replayed: contactOf(1) };
}

// A kept contact, with a picture of a round load.
function contactOf(number) {
  const rows = 16;
  const columns = 24;
  const loads = Buffer.from(Array.from({ length: rows * columns }, (_, i) =>
    Math.round(255 * Math.exp(-((Math.floor(i / columns) - 8) ** 2 +
      (i % columns - 5 * number) ** 2) / 14))));
  const label = CLASSES[number - 1];
  const confidence = 1 - 0.15 * number;
  return { name: `contacts/${number}`, robot: 'left arm', caller: 'robots',
    model_version: 'models/arm/versions/1', layout: 'allegro',
    begin_time_ms: String(NOW_MS - 60_000 * number),
    duration_ns: String(number * 1e9), onset_sequence: '100',
    end_sequence: '400', label, confidence, unknown: 0.03, answers: [
      { question: 'hardness', value: number < 3 ? 'hard' : 'soft',
        probability: confidence, decided: true, revised: false },
      { question: 'mobility', value: number % 2 ? 'unmoved' : 'moved',
        probability: confidence, decided: number < 3, revised: false }],
    max_force: 1.4, together: 1, cut: false, exact: true, given: null,
    shadow: null, picture: { rows, columns,
      loads: loads.toString('base64'), most: 1.4 } };
}
