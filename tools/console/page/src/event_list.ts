// The events of a robot, the newest first.

import { element } from './dom';
import { timeOf, type Robot } from './robots';
import { clock, eventSign, eventText } from './words';

const MOST_SHOWN = 100;

export class EventList {
  readonly root: HTMLElement;
  private readonly list = element('ol', {});
  private readonly empty = element('p', { class: 'quiet' }, 'None so far.');
  private shown = -1;

  // `onTime` is called with the time of an event that somebody clicks.
  constructor(private readonly robot: Robot,
      private readonly onTime: (time: number) => void) {
    this.root = element('section', { class: 'events card' },
      element('h2', {}, 'Events'), this.empty, this.list);
  }

  update(): void {
    const { events, eventCount } = this.robot;
    if (this.shown === eventCount) return;
    const added = Math.min(eventCount - Math.max(this.shown, 0), events.length);
    this.shown = eventCount;
    this.empty.hidden = events.length > 0;
    for (const event of events.slice(events.length - added)) {
      const time = timeOf(this.robot, event.capture_time_ns);
      const button = element('button', { type: 'button' },
        element('span', { class: 'when' }, clock(time)),
        element('span', { class: 'sign', 'aria-hidden': 'true' },
          eventSign(event)),
        element('span', {}, eventText(event, this.robot.stream)));
      button.addEventListener('click', () => this.onTime(time));
      this.list.prepend(element('li', {}, button));
    }
    while (this.list.children.length > MOST_SHOWN) {
      this.list.lastElementChild!.remove();
    }
  }
}
