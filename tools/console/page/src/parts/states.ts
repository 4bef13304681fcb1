// What a part of a page shows while it loads, when it fails, and when it is
// there.

import { ApiError } from '../api';
import { element, setText } from '../dom';

export function errorBox(error: unknown, retry?: () => void): HTMLElement {
  if (error instanceof ApiError && error.reason === 'NO_DATA_DIRECTORY') {
    return emptyBox('This server keeps no data', 'It only classifies. ' +
      'A server keeps data and trains if it is started with a folder:',
    'tactusd --data-dir=FOLDER');
  }
  if (error instanceof ApiError && error.reason === 'NO_CONTACT_LOG') {
    return emptyBox('This server keeps no contacts', 'It forgets what robots ' +
      'touch. A server keeps the last contacts if it is started with a size ' +
      'for them:', 'tactusd --data-dir=FOLDER --keep-contacts=1G');
  }
  const denied = error instanceof ApiError && error.isDenied;
  const box = element('div', { class: denied ? 'denied' : 'error',
    role: denied ? 'note' : 'alert' },
  element('p', {}, denied ? `Read-only: ${textOf(error)}` : textOf(error)));
  if (retry && !denied) {
    const button = element('button', { type: 'button' }, 'Try again');
    button.addEventListener('click', retry);
    box.append(button);
  }
  return box;
}

export function textOf(error: unknown): string {
  if (!(error instanceof Error)) return String(error);
  const reason = error instanceof ApiError && error.reason ?
    ` [${error.reason}]` : '';
  return error.message + reason;
}

export function emptyBox(title: string, text: string, command?: string):
    HTMLElement {
  return element('div', { class: 'nothing' },
    element('h3', {}, title), element('p', { class: 'quiet' }, text),
    ...(command ? [element('pre', {}, command)] : []));
}

const AWAY_MS = 5000;

// A part that loads: it says so, then shows what came or what went wrong. Of
// loads that overlap, the newest counts; what is shown stays until it is there.
export class Part {
  readonly root: HTMLElement;
  private readonly body = element('div', { class: 'part-body' });
  private aborter?: AbortController;
  private timer = 0;
  private closed = false;

  constructor(title: string, ...tools: Node[]) {
    this.root = element('section', { class: 'card part' },
      element('header', { class: 'part-head' },
        element('h2', {}, title), ...tools), this.body);
    this.body.append(element('p', { class: 'quiet' }, 'Loading ...'));
  }

  async load(make: (signal: AbortSignal) => Promise<Node[]>): Promise<void> {
    if (this.closed) return;
    this.aborter?.abort();
    clearTimeout(this.timer);
    const aborter = new AbortController();
    this.aborter = aborter;
    this.root.setAttribute('aria-busy', 'true');
    try {
      const nodes = await make(aborter.signal);
      if (!aborter.signal.aborted) this.show(...nodes);
    } catch (error) {
      if (aborter.signal.aborted) return;
      this.fail(error, () => void this.load(make));
    }
    if (!aborter.signal.aborted) this.root.removeAttribute('aria-busy');
  }

  // Calls `again` after a while, unless something is loaded before or nobody
  // looks.
  later(ms: number, again: () => void): void {
    clearTimeout(this.timer);
    if (this.closed) return;
    this.timer = window.setTimeout(() => {
      if (document.hidden) this.later(ms, again);
      else again();
    }, ms);
  }

  // What is out of reach may come back.
  private fail(error: unknown, again: () => void): void {
    const box = errorBox(error, again);
    // The same text is not read out again.
    if (this.body.textContent !== box.textContent) this.show(box);
    if (error instanceof ApiError && error.isAway) this.later(AWAY_MS, again);
  }

  // The focus stays on what has the same name.
  show(...nodes: Node[]): void {
    const focused = document.activeElement;
    const key = this.body.contains(focused) ? nameOf(focused!) : '';
    this.body.replaceChildren(...nodes);
    if (key === '' || this.body.contains(document.activeElement)) return;
    const again = [...this.body.querySelectorAll<HTMLElement>(
      'a, button, input, select, [tabindex]')].find((node) =>
      nameOf(node) === key);
    again?.focus({ preventScroll: true });
  }

  close(): void {
    this.closed = true;
    this.aborter?.abort();
    clearTimeout(this.timer);
  }
}

function nameOf(node: Element): string {
  return [node.tagName, node.getAttribute('href'),
    node.getAttribute('aria-label') ?? node.textContent].join(' ');
}

// What was done, until the address changes; with `thenGo`, until it changes
// once more.
let keepTold = false;

export function tellDone(text: string, thenGo = false): void {
  const told = document.getElementById('told')!;
  keepTold = thenGo;
  told.hidden = text === '';
  setText(told, text);
}

export function leaveTold(): void {
  if (!keepTold) tellDone('');
  keepTold = false;
}
