// The servers and workers that share a catalogue.

import { element } from '../dom';
import { table, type Cell } from '../parts/table';
import { moment } from '../parts/texts';
import type { Replica } from '../wire';

export function replicaList(replicas: Replica[]): Node[] {
  if (replicas.length === 0) return [];
  return [element('h3', {}, 'Servers and workers of this catalogue'),
    table('Servers and workers of this catalogue', ['Listens on', 'Host',
      'Version', 'Since', 'Health'], replicas.map((replica): Cell[] => [
      (replica.address || 'worker') + (replica.is_this ? ' (this one)' : ''),
      replica.host, replica.version, moment(replica.start_time_ms),
      healthOf(replica)]))];
}

function healthOf({ alive, up_to_date }: Replica): Cell {
  const [kind, text] = !alive ? ['failed', 'silent'] :
    up_to_date ? ['succeeded', 'up to date'] : ['running', 'behind'];
  return element('span', { class: `state is-${kind}` }, text);
}
