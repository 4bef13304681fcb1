// The open streams of a server, also those that a live page does not show.

import type { Api } from '../api';
import type { Counts, OpenStream } from '../messages';
import { emptyBox, Part } from '../parts/states';
import { table, type Cell } from '../parts/table';
import { grouped, moment, shortName } from '../parts/texts';

const AGAIN_MS = 5000;

export class StreamList {
  private readonly part = new Part('Streams');

  constructor(private readonly api: Api) { this.load(); }

  get root(): HTMLElement { return this.part.root; }

  close(): void { this.part.close(); }

  private load(): void {
    void this.part.load(async (signal) => {
      const { streams, next_page_token } = await this.api.call<{
        streams: Listed[]; next_page_token: string; }>(
        'MonitorService/ListStreams', {}, signal);
      this.part.later(AGAIN_MS, () => this.load());
      if (streams.length === 0) {
        return [emptyBox('No stream is open', 'The live page says how to ' +
          'start a simulated robot.')];
      }
      const count = (title: string) => ({ title, number: true });
      const rows = table('Streams, the oldest first', ['Robot', 'Model',
        count('Rate'), count('Frames'), count('Lost'), count('Contacts'),
        'Since', 'Known as', 'From'], streams.map(rowOf));
      return next_page_token === '' ? [rows] :
        [rows, document.createTextNode('The first 100 are shown.')];
    });
  }
}

type Listed = OpenStream & { caller: string; peer: string;
  start_time_ms: string; stream_id: string; counts?: Counts | null; };

function rowOf(stream: Listed): Cell[] {
  const { counts } = stream;
  const rate = counts?.measured_rate_hz ?? 0;
  return [stream.client_id || `stream ${stream.stream_id}`,
    shortName(stream.started.model_version),
    rate > 0 ? `${Math.round(rate)} Hz` : '–',
    grouped(counts?.frames ?? 0), grouped(counts?.frames_missing ?? 0),
    grouped(counts?.contacts ?? 0), moment(stream.start_time_ms),
    stream.caller, stream.peer];
}
