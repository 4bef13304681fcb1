// The questions that begin a job: what to train, and what to evaluate.

import { hrefOf } from '../address';
import { listAll, newRequestId, type Api } from '../api';
import { ask, type Field } from '../parts/dialog';
import { tellDone } from '../parts/states';
import { fullName, shortName } from '../parts/texts';
import type { Dataset, ModelVersion, Operation } from '../wire';

// As proto/tactus/v1/operations.proto has them.
const PRESETS = ['auto', 'paper', 'tuned', 'world', 'ridge', 'trees', 'nearest',
  'pattern', 'whole-skin', 'profile'];
const PROTOCOLS: [string, string][] = [
  ['', 'none: evaluate the model above'],
  ['loco', 'leave one condition out'],
  ['leave-one-material-out', 'leave one material out'],
  ['leave-one-out', 'leave one trial out'],
  ['k-fold', 'ten folds'],
];
const presets = (first: string): [string, string][] =>
  [['', first], ...PRESETS.map((name): [string, string] => [name, name])];

export async function datasetNames(api: Api): Promise<string[]> {
  const all = await listAll<Dataset>(api, 'TrainingService/ListDatasets',
    'datasets').catch(() => []);
  return all.filter((dataset) => dataset.latest_version > 0)
    .map(({ name, latest_version }) => `${shortName(name)}@${latest_version}`);
}

async function modelNames(api: Api): Promise<string[]> {
  const all = await listAll<ModelVersion>(api, 'ModelService/ListModelVersions',
    'versions').catch(() => []);
  return all.map(({ name }) => shortName(name));
}

function datasetField(names: string[]): Field {
  return { name: 'dataset', label: 'Dataset version', required: true,
    list: names, value: names[0] ?? '',
    hint: 'Like arm@2; without a version the newest.' };
}

export async function askTrain(api: Api): Promise<void> {
  const [datasets, models] = await Promise.all(
    [datasetNames(api), modelNames(api)]);
  const request_id = newRequestId();
  ask({
    title: 'Train a model',
    fields: [
      datasetField(datasets),
      { name: 'model', label: 'Model', required: true,
        list: [...new Set(models.map((name) => name.split('@')[0]!))],
        value: (datasets[0] ?? '').split('@')[0]!,
        hint: 'It gets a new version, and is made if there is none.' },
      { name: 'preset', label: 'Preset', type: 'select',
        options: presets('as the trials ask for') },
      { name: 'shares', label: 'Shares of the classes', type: 'select',
        options: [['', 'as recorded'], ['CLASS_SHARES_EVEN', 'even']] },
      { name: 'networks', label: 'LSTM networks', type: 'number', min: '0',
        max: '64', hint: 'Empty: as many as the preset wants.' },
      { name: 'seed', label: 'Seed', type: 'number', min: '1', value: '1' },
      { name: 'skip', label: 'Leave out trials that cannot be used',
        type: 'check' },
      { name: 'note', label: 'Note' },
    ],
    action: 'Train',
    run: async (values) => {
      const spec = {
        dataset_version: fullName('datasets', values.dataset!),
        model: fullName('models', values.model!.split('@')[0]!),
        preset: values.preset, note: values.note, seed: values.seed || '0',
        skip_unusable: values.skip === 'yes',
        ...(values.shares ? { shares: values.shares } : {}),
        ...(values.networks ? { networks: Number(values.networks) } : {}),
      };
      openJob(api, (await api.call<{ operation: Operation }>(
        'TrainingService/TrainModel', { spec, request_id })).operation);
    },
  });
}

// Of a version like "arm@3", or of what a person chooses.
export async function askEvaluate(api: Api, version: string): Promise<void> {
  const [datasets, models] = await Promise.all(
    [datasetNames(api), modelNames(api)]);
  const request_id = newRequestId();
  ask({
    title: 'Evaluate',
    fields: [
      datasetField(datasets),
      { name: 'model', label: 'Model version', list: models, value: version,
        hint: 'Like arm@3. Empty: models are fitted for the protocol.' },
      { name: 'protocol', label: 'Protocol', type: 'select',
        options: PROTOCOLS },
      { name: 'preset', label: 'Preset of the protocol', type: 'select',
        options: presets('as the trials ask for') },
    ],
    action: 'Evaluate',
    run: async (values) => {
      const dataset_version = fullName('datasets', values.dataset!);
      const spec = values.protocol ? { dataset_version,
        protocol: values.protocol,
        train: { dataset_version, preset: values.preset },
      } : { dataset_version,
        model_version: fullName('models', values.model!) };
      openJob(api, (await api.call<{ operation: Operation }>(
        'TrainingService/EvaluateModel', { spec, request_id })).operation);
    },
  });
}

export function openJob(api: Api, operation: Operation): void {
  const number = shortName(operation.name);
  location.hash = hrefOf('train', api.server, 'job', number);
  tellDone(`Job ${number} is requested.`, true);
}
