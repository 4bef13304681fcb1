// The controls of time: pause, the moment that is shown, and how much of the
// past the curves show.

import { element, setAttribute, setText } from './dom';
import { clock } from './words';

const SPANS = [
  { seconds: 15, text: '15 s' },
  { seconds: 60, text: '1 min' },
  { seconds: 180, text: '3 min' },
];

export class Transport {
  readonly root: HTMLElement;
  readonly slider = element('input', { type: 'range', min: '0', max: '0',
    step: '1', 'aria-label': 'Moment' });
  span = SPANS[1]!.seconds;
  private readonly button = element('button', { type: 'button',
    class: 'pause', 'aria-keyshortcuts': 'Space' }, 'Pause');
  private readonly time = element('output', { class: 'time' });
  private readonly spans = element('div', { class: 'spans', role: 'group',
    'aria-label': 'Length of the curves' });

  constructor(onPause: () => void, onMoment: (index: number) => void,
      onSpan: () => void) {
    this.button.addEventListener('click', onPause);
    this.slider.addEventListener('input', () =>
      onMoment(Number(this.slider.value)));
    for (const { seconds, text } of SPANS) {
      const choice = element('button', { type: 'button',
        'aria-pressed': String(seconds === this.span) }, text);
      choice.addEventListener('click', () => {
        this.span = seconds;
        for (const other of this.spans.children) {
          other.setAttribute('aria-pressed', String(other === choice));
        }
        onSpan();
      });
      this.spans.append(choice);
    }
    this.root = element('div', { class: 'transport' },
      this.button, this.slider, this.time, this.spans);
  }

  // `paused`: the moment stays while new frames come.
  show(first: number, end: number, at: number, time: number,
      paused: boolean): void {
    this.slider.min = String(first);
    this.slider.max = String(Math.max(first, end - 1));
    this.slider.value = String(at);
    setAttribute(this.slider, 'aria-valuetext', clock(time));
    setText(this.time, paused ? clock(time) : `live ${clock(time)}`);
    setText(this.button, paused ? 'Go on' : 'Pause');
  }
}
