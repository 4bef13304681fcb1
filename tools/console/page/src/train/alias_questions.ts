// The questions that change an alias. Each change says which state of the
// alias it is about, so that two people do not overwrite each other.

import { listAll, newRequestId, type Api } from '../api';
import { ask } from '../parts/dialog';
import { tellDone } from '../parts/states';
import { fullName, shortName } from '../parts/texts';
import type { Alias, ModelVersion, Operation } from '../wire';
import { isActive } from './job_list';
import { datasetNames, openJob } from './questions';

// `version` like "arm@3".
export async function askPromote(api: Api, version: string,
    done: () => void): Promise<void> {
  const aliases = await aliasesOf(api);
  const request_id = newRequestId();
  ask({
    title: `Promote ${version}`,
    text: 'New streams that ask for the alias get this version. If the alias ' +
      'has a gate, both versions are compared first.',
    fields: [
      { name: 'alias', label: 'Alias', value: 'default', required: true,
        list: aliases.map(({ name }) => shortName(name)) },
      { name: 'force', label: 'Even if the gate is not passed; the history ' +
        'records it', type: 'check' },
    ],
    action: 'Promote',
    run: async ({ alias, force }) => {
      const known = aliases.find(({ name }) => name === `aliases/${alias}`);
      const { operation } = await api.call<{ operation: Operation }>(
        'ModelService/PromoteModel', { request_id, spec: {
          alias: `aliases/${alias}`, etag: known?.etag ?? '',
          model_version: fullName('models', version),
          force: force === 'yes' } });
      if (isActive(operation) || operation.error) {
        return openJob(api, operation);
      }
      tellDone(`${alias} names ${version} now.`);
      done();
    },
  });
}

export function askRollback(api: Api, alias: Alias, done: () => void): void {
  const name = shortName(alias.name);
  const before = shortName(alias.previous_version);
  ask({
    title: `Roll back ${name}`,
    text: `${name} names ${shortName(alias.model_version)}. After this it ` +
      `names ${before}, and new streams get that.`,
    fields: [], action: `Roll back to ${before}`, danger: true,
    run: async () => {
      await api.call('ModelService/RollbackAlias',
        { name: alias.name, etag: alias.etag });
      tellDone(`${name} names ${before} again.`);
      done();
    },
  });
}

export async function askCanary(api: Api, alias: Alias, done: () => void):
    Promise<void> {
  const versions = await listAll<ModelVersion>(api,
    'ModelService/ListModelVersions', 'versions').catch(() => []);
  const name = shortName(alias.name);
  ask({
    title: `Canary of ${name}`,
    text: 'Some robots, always the same ones, get a second version.',
    fields: [
      { name: 'version', label: 'Version',
        list: versions.map((version) => shortName(version.name)),
        value: alias.canary ? shortName(alias.canary.model_version) : '',
        hint: 'Empty: no canary.' },
      { name: 'share', label: 'Share of the robots in %', type: 'number',
        min: '0.1', max: '100', step: '0.1',
        value: String((alias.canary?.per_mille ?? 50) / 10) },
    ],
    action: 'Set',
    run: async ({ version, share }) => {
      await update(api, { ...alias, canary: version ? {
        model_version: fullName('models', version),
        per_mille: Math.round(10 * Number(share)) } : null });
      tellDone(version ? `${share} % of the robots get ${version}.` :
        `${name} has no canary now.`);
      done();
    },
  });
}

export async function askGate(api: Api, alias: Alias, done: () => void):
    Promise<void> {
  const { gate } = alias;
  const datasets = await datasetNames(api);
  const margin = (name: string, label: string, value?: number) => ({ name,
    label, type: 'number' as const, min: '0', step: 'any',
    value: String(value ?? 0) });
  ask({
    title: `Gate of ${shortName(alias.name)}`,
    text: 'A new version must be as good as the one that it replaces, on the ' +
      'trials of one dataset version.',
    fields: [
      { name: 'data', label: 'Dataset version', hint: 'Empty: no gate.',
        list: datasets,
        value: gate ? shortName(gate.dataset_version) : '' },
      margin('accuracy_margin', 'Accuracy may be less by',
        gate?.accuracy_margin),
      margin('log_loss_margin', 'Log-loss may be more by',
        gate?.log_loss_margin),
      margin('calibration_margin', 'Calibration error may be more by',
        gate?.calibration_margin),
    ],
    action: 'Set',
    run: async (values) => {
      await update(api, { ...alias, gate: values.data ? {
        dataset_version: fullName('datasets', values.data),
        accuracy_margin: Number(values.accuracy_margin),
        log_loss_margin: Number(values.log_loss_margin),
        calibration_margin: Number(values.calibration_margin) } : null });
      tellDone(values.data ? 'The gate is set.' : 'There is no gate now.');
      done();
    },
  });
}

async function update(api: Api, { name, etag, canary, gate }: Alias):
    Promise<void> {
  await api.call('ModelService/UpdateAlias', { name, etag,
    ...(canary ? { canary } : {}), ...(gate ? { gate } : {}) });
}

async function aliasesOf(api: Api): Promise<Alias[]> {
  try {
    return (await api.call<{ aliases: Alias[] }>('ModelService/ListAliases'))
      .aliases;
  } catch {
    return [];
  }
}
