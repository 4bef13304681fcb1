// One contact, open beside the list: what was answered, its frames once more,
// and what another model says.

import type { Api } from '../api';
import { element, setText } from '../dom';
import { errorBox } from '../parts/states';
import { fullName } from '../parts/texts';
import type { Logged, Replayed } from './messages';
import { contactFacts, opinionTable } from './opinions';
import { Replay } from './replay';
import { ReplayView } from './replay_view';
import { numberOf, robotOf, timeText } from './texts';

// So long the current contact has to stay until its frames are asked for.
const REST_MS = 120;
// Taxels of a response, in values, that are within the console's bound.
const MOST_VALUES = 600_000;
const MOST_FRAMES = 200;
const MOST_AXES = 3;

export class ContactView {
  readonly root: HTMLElement;
  private readonly title = element('h2');
  private readonly subtitle = element('p', { class: 'quiet' });
  private readonly about = element('div');
  private readonly stage = element('div', { class: 'stage' });
  private readonly opinions = element('div');
  private readonly curves = element('div');
  private readonly model = element('select', { id: 'second-opinion' });
  private readonly ask: HTMLElement;
  private view?: ReplayView;
  private contact?: Logged;
  private aborter?: AbortController;
  private timer = 0;

  // `labels`: what gives labels; it stands below the contact's name.
  constructor(private readonly api: Api, labels: HTMLElement,
      private readonly onClasses: (version: string, names: string[]) => void) {
    this.ask = element('div', { class: 'ask-model' },
      element('h3', {}, 'Answers'),
      element('label', { for: 'second-opinion' }, 'Ask another model'),
      this.model);
    this.model.addEventListener('change', () => this.load());
    this.setVersions([]);
    this.root = element('section', { class: 'card contact-view',
      'aria-label': 'The contact' },
    element('header', {}, this.title, this.subtitle), labels, this.stage,
    this.ask, this.opinions, this.curves, this.about);
    this.root.hidden = true;
  }

  // Like "arm@3".
  setVersions(versions: string[]): void {
    const { value } = this.model;
    this.model.replaceChildren(
      element('option', { value: '' }, 'none: the one that answered'),
      ...versions.map((name) => element('option', { value: name }, name)));
    this.model.value = versions.includes(value) ? value : '';
  }

  open(contact: Logged): void {
    if (this.contact?.name === contact.name &&
        this.contact.begin_time_ms === contact.begin_time_ms) {
      return;
    }
    this.contact = contact;
    this.root.hidden = false;
    setText(this.title, `Contact ${numberOf(contact)}`);
    setText(this.subtitle, [robotOf(contact),
      timeText(contact.begin_time_ms)].join(', '));
    this.about.replaceChildren(contactFacts(contact));
    this.view?.player.stop();
    this.load();
  }

  close(): void {
    this.aborter?.abort();
    clearTimeout(this.timer);
    this.view?.close();
    this.view = undefined;
    this.contact = undefined;
    this.root.hidden = true;
  }

  togglePlay(): void { this.player?.toggle(); }

  step(by: number): void { this.player?.step(by); }

  // Not that of the contact before.
  private get player() {
    return this.root.hasAttribute('aria-busy') ? undefined : this.view?.player;
  }

  private load(): void {
    this.aborter?.abort();
    clearTimeout(this.timer);
    this.root.setAttribute('aria-busy', 'true');
    if (this.view === undefined && this.stage.children.length === 0) {
      this.stage.replaceChildren(
        element('p', { class: 'quiet' }, 'Loading ...'));
    }
    this.timer = window.setTimeout(() => void this.replay(), REST_MS);
  }

  private async replay(): Promise<void> {
    const contact = this.contact!;
    const aborter = new AbortController();
    this.aborter = aborter;
    const other = this.model.value;
    try {
      const replayed = await this.api.call<Replayed>(
        'ContactLogService/ReplayContact', { name: contact.name,
          max_frames: framesOf(contact),
          ...(other ? { model: fullName('models', other) } : {}) },
        aborter.signal);
      if (aborter.signal.aborted) return;
      this.show(replayed, fullName('models', other) !==
        contact.model_version && other !== '');
    } catch (error) {
      if (aborter.signal.aborted) return;
      this.clear();
      this.stage.replaceChildren(errorBox(error, () => this.load()));
    }
    this.root.removeAttribute('aria-busy');
  }

  private show(replayed: Replayed, other: boolean): void {
    this.clear();
    if (!other) {
      this.onClasses(replayed.contact.model_version,
        replayed.started.class_names);
    }
    this.opinions.replaceChildren(opinionTable(replayed, other));
    if (replayed.frames.length === 0) return;
    this.view = new ReplayView(new Replay(replayed));
    this.stage.replaceChildren(this.view.stage);
    this.curves.replaceChildren(this.view.curves);
  }

  private clear(): void {
    this.view?.close();
    this.view = undefined;
    this.stage.replaceChildren();
    this.opinions.replaceChildren();
    this.curves.replaceChildren();
  }
}

// As many as fit into a response, whatever the axes of the skin.
function framesOf({ picture }: Logged): number {
  const taxels = picture ? picture.rows * picture.columns : 0;
  if (taxels === 0) return MOST_FRAMES;
  return Math.max(1, Math.min(MOST_FRAMES,
    Math.floor(MOST_VALUES / (taxels * MOST_AXES))));
}
