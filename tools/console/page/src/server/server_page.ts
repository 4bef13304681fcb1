// The server page: how the server is, what it is doing for whom, who changed
// what, and its end.

import type { Api } from '../api';
import { element } from '../dom';
import type { Page, PageContext, PageKind } from '../page';
import { ask } from '../parts/dialog';
import { Part, tellDone } from '../parts/states';
import { button, facts, pageHead } from '../parts/table';
import { bytes, moment, span, word } from '../parts/texts';
import type { ServerInfo } from '../wire';
import { plural } from '../words';
import { AuditList } from './audit_list';
import { ClientUse } from './client_use';
import { HealthView } from './health_view';
import { ModelUse } from './model_use';
import { replicaList } from './replica_list';
import { StreamList } from './stream_list';

const AGAIN_MS = 7000;

export const SERVER: PageKind = {
  id: 'server',
  title: 'Server',
  ofOneServer: true,
  open: (context) => new ServerPage(context),
};

interface View {
  root: HTMLElement;
  close(): void;
}

class ServerPage implements Page {
  private readonly drain: HTMLButtonElement;
  private readonly info: Part;
  private readonly others: View[];
  private readonly api: Api;

  constructor({ api, main }: PageContext) {
    this.api = api;
    this.drain = button('Drain ...', () => this.askDrain(), 'danger');
    this.drain.disabled = true;
    this.info = new Part('State', this.drain);
    const health = new HealthView(api);
    const below = [new StreamList(api), new ClientUse(api), new ModelUse(api),
      new AuditList(api)];
    this.others = [health, ...below];
    main.replaceChildren(element('div', { class: 'page' },
      pageHead('Server', undefined,
        element('p', { class: 'model' }, api.address)),
      health.root, this.info.root, ...below.map(({ root }) => root)));
    this.load();
    void api.may('admin').then((may) => { this.drain.disabled = !may; });
  }

  close(): void {
    for (const part of [this.info, ...this.others]) part.close();
  }

  private load(): void {
    void this.info.load(async (signal) => {
      const info = await this.api.call<ServerInfo>(
        'AdminService/GetServerInfo', {}, signal);
      this.info.later(AGAIN_MS, () => this.load());
      return [element('div', { class: 'fact-columns' },
        ...groupsOf(info).map(([title, pairs]) => element('div', {},
          element('h3', {}, title), facts(...pairs)))),
      ...replicaList(info.replicas)];
    });
  }

  private askDrain(): void {
    const { address } = this.api;
    ask({
      title: 'Drain the server',
      text: 'It takes no new streams. Open ones may finish within its grace; ' +
        'then the server ends. Only whoever runs its host can start it again.',
      fields: [{ name: 'typed', typed: address,
        label: `Type ${address} to go on` }],
      action: 'Drain', danger: true,
      run: async () => {
        const { streams, grace_ms } = await this.api.call<{ streams: number;
          grace_ms: string; }>('AdminService/Drain');
        tellDone(`The server ends: ${plural(streams, 'stream')} may go on ` +
          `for ${span(grace_ms)}.`);
      },
    });
  }
}

function groupsOf(info: ServerInfo): [string, [string, string][]][] {
  const groups: [string, [string, string][]][] = [['Program', [
    ['Version', info.version?.version ?? '?'],
    ['Runs for', span(info.uptime_ms)],
    ['Since', moment(info.start_time_ms)],
    ['Streams', `${info.streams} of at most ${info.max_streams}`],
    ['You are', info.caller]]]];
  if (info.data) {
    groups.push(['Data directory', [
      ['Folder', info.data.folder],
      ['Trials and models', bytes(info.data.blob_bytes)],
      ['Uploads', bytes(info.data.upload_bytes)],
      ['Jobs', bytes(info.data.job_bytes)],
      ['Catalogue', bytes(info.data.catalog_bytes)],
      ['Free', bytes(info.data.free_bytes)]]]);
  } else {
    groups.push(['Data directory', [['Folder', 'none: start tactusd with ' +
      '--data-dir to keep data and train']]]);
  }
  groups.push(['Jobs', info.jobs.length === 0 ? [['All', '0']] :
    info.jobs.map(({ state, count }): [string, string] =>
      [word(state), String(count)])]);
  if (info.quotas) {
    const { quotas } = info;
    const limit = (name: string, text: (value: string) => string): string =>
      Number(quotas[name]) === 0 ? 'no limit' : text(quotas[name]!);
    groups.push(['Each client may have', [
      ['Trials', limit('stored_bytes', bytes)],
      ['Models', limit('model_bytes', bytes)],
      ['Datasets', limit('datasets', String)],
      ['Waiting jobs', limit('queued_jobs', String)],
      ['Streams', limit('streams', String)]]]);
  }
  return groups;
}
