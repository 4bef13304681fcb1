// What is said about a robot beside its skin: the scale of the colours, its
// rate, what was lost, and whether what is shown is old.

import { element, setText } from './dom';
import { geometryOf, silentMs, type Robot } from './robots';
import { number, plural, unitOf } from './words';

// A robot that sends nothing for so long is shown as silent.
const SILENT_MS = 1000;

// Why a robot's answers are old; empty if they are not.
export function stalenessOf(robot: Robot, now: number): string {
  if (robot.endedAt !== undefined) return 'ended';
  if (robot.offline) return 'offline';
  const silent = silentMs(robot, now);
  return silent > SILENT_MS ? `silent for ${duration(silent)}` : '';
}

function duration(ms: number): string {
  const s = Math.floor(ms / 1000);
  if (s < 120) return `${s} s`;
  return s < 7200 ? `${Math.floor(s / 60)} min` :
    `${Math.floor(s / 3600)} h`;
}

export class FactsView {
  readonly root: HTMLElement;
  private readonly labels = [0, 0.25, 1].map(() => element('span'));
  private readonly rate = element('p', { class: 'rate' });
  private readonly losses = element('p', { class: 'losses' });

  constructor(private readonly robot: Robot) {
    this.root = element('div', { class: 'facts' },
      element('div', { class: 'scale' },
        element('span', { class: 'scale-bar', 'aria-hidden': 'true' }),
        element('span', {}, unitOf(geometryOf(robot))),
        element('span', { class: 'scale-labels' }, ...this.labels)),
      element('div', { class: 'counts' }, this.rate, this.losses));
  }

  update(): void {
    const { counts, full } = this.robot;
    setText(this.labels[0]!, '0');
    setText(this.labels[1]!, number(full / 4));
    setText(this.labels[2]!, number(full));
    if (counts === undefined) return;
    const rate = counts.measured_rate_hz;
    setText(this.rate, [
      plural(Number(counts.contacts), 'contact'),
      rate > 0 ? `${Math.round(rate)} Hz` : '',
    ].filter((text) => text !== '').join(', '));
    const lost = Number(counts.frames_missing);
    const dropped = Number(counts.superseded);
    setText(this.losses, [
      lost > 0 ? `${plural(lost, 'frame')} lost` : '',
      dropped > 0 ? `${plural(dropped, 'answer')} left out` : '',
    ].filter((text) => text !== '').join(', '));
  }
}

// Says in large letters that what it lies upon is old.
export class StaleView {
  readonly root: HTMLElement;
  private readonly text = element('span');

  constructor() {
    this.root = element('p', { class: 'stale' },
      element('span', { class: 'stale-sign', 'aria-hidden': 'true' }, '!'),
      this.text);
    this.root.hidden = true;
  }

  show(staleness: string): void {
    this.root.hidden = staleness === '';
    setText(this.text, staleness);
  }
}
