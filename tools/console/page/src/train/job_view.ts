// One job: its state, its learning curve, its log, and what it made.

import { hrefOf } from '../address';
import { ApiError, type Api } from '../api';
import { element, setText } from '../dom';
import { copiedValue } from '../parts/copied_value';
import { ask } from '../parts/dialog';
import { LearningChart } from '../parts/learning_chart';
import { Part } from '../parts/states';
import { button, facts, link, type Cell } from '../parts/table';
import { moment, nameParts, shortName, span } from '../parts/texts';
import type { LearningPoint, Operation } from '../wire';
import { comparisonView, evaluationView } from './evaluation_view';
import { isActive, purposeOf, stateOf } from './job_list';

// A job is asked for after pauses that grow while nothing is new.
const FIRST_MS = 1000;
const LONGEST_MS = 8000;

interface Watched {
  operation: Operation;
  points: LearningPoint[];
}

export class JobView {
  readonly root: HTMLElement;
  private readonly cancel = button('Cancel the job ...',
    () => this.askCancel(), 'danger');
  private readonly state = new Part('State', this.cancel);
  private readonly chart = new LearningChart();
  private readonly curve = new Part('Learning curve', this.chart.choice);
  private readonly log = new Part('Log');
  private readonly logText = element('pre', { class: 'log', tabindex: '0',
    role: 'region', 'aria-label': 'Log' });
  private readonly result = element('div', { class: 'stack' });
  private pause = FIRST_MS;
  private seen = '';
  private mayCancel = true;

  constructor(private readonly api: Api, private readonly number: string) {
    this.cancel.hidden = true;
    this.curve.root.hidden = true;
    this.root = element('div', { class: 'stack' }, this.state.root,
      this.result, this.curve.root, this.log.root);
    this.look();
    void api.may('trainer').then((may) => {
      this.mayCancel = may !== false;
      this.cancel.disabled = !this.mayCancel;
    });
  }

  close(): void {
    for (const part of [this.state, this.curve, this.log]) part.close();
    this.chart.close();
  }

  private look(): void {
    void this.state.load(async (signal) => {
      const { operation, points } = await this.read(signal);
      this.showCurve(points);
      this.readLog();
      const active = isActive(operation);
      this.cancel.hidden = !active;
      const now = JSON.stringify([operation, points.length]);
      this.pause = now === this.seen ?
        Math.min(1.5 * this.pause, LONGEST_MS) : FIRST_MS;
      if (now !== this.seen) this.showResult(operation);
      this.seen = now;
      if (active) this.state.later(this.pause, () => this.look());
      return [this.factsOf(operation)];
    });
  }

  private async read(signal: AbortSignal): Promise<Watched> {
    const request = { name: `operations/${this.number}` };
    try {
      return await this.api.call<Watched>('OperationService/WatchOperation',
        request, signal);
    } catch (error) {
      // The points of a very long training are too many for one response.
      if (!(error instanceof ApiError) || error.code !== 'RESOURCE_EXHAUSTED') {
        throw error;
      }
      const { operation } = await this.api.call<Watched>(
        'OperationService/GetOperation', request, signal);
      return { operation, points: [] };
    }
  }

  private factsOf(job: Operation): HTMLElement {
    const { server } = this.api;
    const rows: [string, Cell][] = [['What', purposeOf(job)],
      ['State', stateOf(job)]];
    if (isActive(job) && job.progress && Number(job.progress.remaining_ms)) {
      rows.push(['Left of the phase', span(job.progress.remaining_ms)]);
    }
    if (job.error) rows.push(['Error', errorOf(job)]);
    const made = job.result?.model_version;
    if (made) {
      rows.push(['Made', link(hrefOf('train', server, 'model',
        ...nameParts(made)), shortName(made))]);
    }
    const data = job.train?.dataset_version ?? job.evaluate?.dataset_version;
    if (data) {
      rows.push(['Data', link(hrefOf('data', server, ...nameParts(data)),
        shortName(data))]);
    }
    if (job.train?.preset) rows.push(['Preset', job.train.preset]);
    if (job.train?.note) rows.push(['Note', job.train.note]);
    rows.push(['Requested', `${moment(job.create_time_ms)} by ` +
      job.requester]);
    if (job.request_id) {
      rows.push(['Request id', copiedValue('request id', job.request_id)]);
    }
    if (Number(job.start_time_ms) > 0 && Number(job.end_time_ms) > 0) {
      rows.push(['Took', span(Number(job.end_time_ms) -
        Number(job.start_time_ms))]);
    }
    return facts(...rows);
  }

  private showCurve(points: LearningPoint[]): void {
    this.curve.root.hidden = points.length === 0;
    if (points.length === 0) return;
    if (!this.chart.root.isConnected) this.curve.show(this.chart.root);
    this.chart.show(points);
  }

  private readLog(): void {
    void this.log.load(async (signal) => {
      const { messages } = await this.api.call<{ messages: { data: string;
        omitted_bytes: string; }[] }>('OperationService/ReadOperationLog',
      { name: `operations/${this.number}` }, signal);
      const text = decodeAll(messages.map(({ data }) => data));
      const omitted = Number(messages[0]?.omitted_bytes ?? 0);
      const all = (omitted > 0 ? `(${omitted} bytes before)\n` : '') + text;
      const atEnd = this.logText.scrollTop + this.logText.clientHeight >=
        this.logText.scrollHeight - 4;
      setText(this.logText, all);
      if (atEnd) {
        requestAnimationFrame(() => {
          this.logText.scrollTop = this.logText.scrollHeight;
        });
      }
      return all === '' ?
        [element('p', { class: 'quiet' }, 'Nothing was written.')] :
        [this.logText];
    });
  }

  private showResult({ result }: Operation): void {
    const nodes: Node[] = [];
    if (result?.comparison) nodes.push(comparisonView(result.comparison));
    if (result?.evaluation) nodes.push(
      evaluationView([{ name: '', report: result.evaluation }]));
    if (result?.preset_choice) {
      const { preset, candidates, contacts } = result.preset_choice;
      nodes.push(element('section', { class: 'card part' },
        element('h2', {}, `The preset ${preset} was chosen`),
        facts(...candidates.map((candidate): [string, string] =>
          [candidate.preset, candidate.unfit ||
            `${candidate.correct} of ${contacts} contacts right`]))));
    }
    this.result.replaceChildren(...nodes);
  }

  private askCancel(): void {
    ask({ title: `Cancel job ${this.number}?`, fields: [], danger: true,
      text: 'What it has done so far is lost.', action: 'Cancel the job',
      run: async () => {
        await this.api.call('OperationService/CancelOperation',
          { name: `operations/${this.number}` });
        this.look();
      } });
  }
}

function errorOf(job: Operation): string {
  const reason = job.error!.details[0]?.reason;
  return job.error!.message + (reason ? ` [${reason}]` : '');
}

// Bytes of a log are no text before they are together.
function decodeAll(parts: string[]): string {
  const bytes = parts.map((part) =>
    Uint8Array.from(atob(part), (c) => c.charCodeAt(0)));
  const all = new Uint8Array(bytes.reduce((sum, b) => sum + b.length, 0));
  let at = 0;
  for (const part of bytes) {
    all.set(part, at);
    at += part.length;
  }
  return new TextDecoder().decode(all);
}
