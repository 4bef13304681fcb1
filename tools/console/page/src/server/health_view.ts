// Whether the server takes streams, and what is wrong with it.

import { ApiError, type Api } from '../api';
import { element } from '../dom';
import { Part } from '../parts/states';
import type { ServerInfo } from '../wire';
import { plural } from '../words';

const AGAIN_MS = 7000;

export class HealthView {
  private readonly part = new Part('Health');

  constructor(private readonly api: Api) { this.load(); }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private load(): void {
    void this.part.load(async (signal) => {
      const { status } = await this.api.call<{ status: string }>(
        'Health/Check', {}, signal);
      const info = await this.readInfo(signal);
      this.part.later(AGAIN_MS, () => this.load());
      return healthOf(status === 'SERVING', info);
    });
  }

  // People without the role for it see the health alone.
  private async readInfo(signal: AbortSignal): Promise<ServerInfo | undefined> {
    try {
      return await this.api.call<ServerInfo>('AdminService/GetServerInfo', {},
        signal);
    } catch (error) {
      if (error instanceof ApiError && error.isDenied) return undefined;
      throw error;
    }
  }
}

function healthOf(isServing: boolean, info?: ServerInfo): Node[] {
  const reasons = info ? reasonsOf(info) : [];
  const [kind, text] = !isServing ? ['failed', 'Not serving: it starts or ' +
    'ends, and takes no new streams.'] :
    reasons.length > 0 ? ['degraded', 'Degraded: it serves, but not all is ' +
      'well.'] : ['succeeded', 'Serving'];
  return [element('p', { class: `health is-${kind}` }, text),
    ...(reasons.length === 0 ? [] : [element('ul', { class: 'warn reasons' },
      ...reasons.map((reason) => element('li', {}, reason)))])];
}

function reasonsOf({ not_served, replicas, streams, max_streams }: ServerInfo):
    string[] {
  const nameOf = ({ address, name }: { address: string; name: string }) =>
    address ? `The server ${address}` : `The worker ${name}`;
  const others = replicas.filter(({ is_this }) => !is_this);
  return [
    ...(max_streams > 0 && streams >= max_streams ? ['It refuses new ' +
      `streams: all ${plural(max_streams, 'place')} are taken.`] : []),
    ...not_served.map((text) => `A stored model is not served: ${text}`),
    ...others.filter(({ alive }) => !alive).map((replica) =>
      `${nameOf(replica)} on ${replica.host} has not been heard of for ten ` +
      'seconds.'),
    ...replicas.filter(({ alive, up_to_date }) => alive && !up_to_date)
      .map((replica) => `${nameOf(replica)} on ${replica.host} does not ` +
        'serve the newest change of models or aliases yet.'),
  ];
}
