// What each client has of what the server grants it.

import { listAll, type Api } from '../api';
import type { OpenStream } from '../messages';
import { emptyBox, Part } from '../parts/states';
import { table, type Cell } from '../parts/table';
import { bytes } from '../parts/texts';
import type { Dataset, ModelVersion, Operation, ServerInfo } from '../wire';

const AGAIN_MS = 15_000;

interface Use {
  streams: number;
  datasets: number;
  queued_jobs: number;
  model_bytes: number;
}

export class ClientUse {
  private readonly part = new Part('Quotas');

  constructor(private readonly api: Api) { this.load(); }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private load(): void {
    void this.part.load(async (signal) => {
      const { quotas, data } = await this.api.call<ServerInfo>(
        'AdminService/GetServerInfo', {}, signal);
      const uses = await this.readUses(Boolean(data), signal);
      this.part.later(AGAIN_MS, () => this.load());
      if (uses.size === 0) {
        return [emptyBox('Nobody uses anything', 'There are no streams, ' +
          'datasets, waiting jobs or models of clients.')];
      }
      const cell = (name: keyof Use, use: Use, text: (value: number) => string):
          string => {
        const limit = Number(quotas?.[name] ?? 0);
        return text(use[name]) + (limit > 0 ? ` of ${text(limit)}` : '');
      };
      const count = (title: string) => ({ title, number: true });
      return [table('Use of quotas by client', ['Client', count('Streams'),
        count('Datasets'), count('Waiting jobs'), count('Models')],
      [...uses].sort(([a], [b]) => a < b ? -1 : 1).map(([client, use]):
          Cell[] => [client, cell('streams', use, String),
        cell('datasets', use, String), cell('queued_jobs', use, String),
        cell('model_bytes', use, bytes)]))];
    });
  }

  // A server without a folder keeps streams alone.
  private async readUses(keepsData: boolean, signal: AbortSignal):
      Promise<Map<string, Use>> {
    const { api } = this;
    const uses = new Map<string, Use>();
    const add = (client: string, name: keyof Use, more: number) => {
      const use = uses.get(client) ??
        { streams: 0, datasets: 0, queued_jobs: 0, model_bytes: 0 };
      use[name] += more;
      uses.set(client, use);
    };
    const streams = await listAll<OpenStream & { caller: string }>(api,
      'MonitorService/ListStreams', 'streams', signal);
    for (const { caller } of streams) add(caller, 'streams', 1);
    if (!keepsData) return uses;
    const versions = await listAll<ModelVersion>(api,
      'ModelService/ListModelVersions', 'versions', signal);
    for (const { built_in, requester, bytes: size } of versions) {
      if (!built_in) add(requester, 'model_bytes', Number(size));
    }
    for (const { requester } of await listAll<Dataset>(api,
      'TrainingService/ListDatasets', 'datasets', signal)) {
      add(requester, 'datasets', 1);
    }
    const { operations } = await api.call<{ operations: Operation[] }>(
      'OperationService/ListOperations', { page_size: 1000,
        state: 'STATE_QUEUED' }, signal);
    for (const { requester } of operations) add(requester, 'queued_jobs', 1);
    return uses;
  }
}
