// The page's connection to its console.

import { decode, type Decoded } from './messages';

export interface Session {
  signed_in: boolean;
  // False: the servers serve this machine without a token, and there is nothing
  // to sign out of.
  needs_token?: boolean;
  // As whom the servers know the person, if the console says so.
  name?: string;
  csrf: string;
  // Lets other programs watch in the person's name; empty without a sign-in.
  watch_key?: string;
  servers: string[];
}

const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 5000;
// The console's code for a sign-in that is over.
const SIGNED_OUT = 4401;
// Without pictures to wait for, as in a hidden tab.
const HIDDEN_MS = 1000;

export async function readSession(): Promise<Session> {
  const response = await fetch('/api/session', { cache: 'no-store' });
  if (!response.ok) throw new Error(`status ${response.status}`);
  return await response.json() as Session;
}

// The session, or the text of what is wrong.
export async function signIn(token: string): Promise<Session | string> {
  const response = await fetch('/api/sign-in', {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ token }),
  });
  const json = await response.json() as Session & { error?: string };
  return response.ok ? json : json.error ?? `status ${response.status}`;
}

export async function signOut(csrf: string): Promise<void> {
  await fetch('/api/sign-out',
    { method: 'POST', headers: { 'X-CSRF-Token': csrf } });
}

export interface LiveHandlers {
  onMessage: (decoded: Decoded) => void;
  onLost: () => void;
  onSignedOut: () => void;
}

// Watches the robots until stop(); connects again after a loss. Whoever draws
// calls askNext() after it has drawn, and gets one more message. A browser that
// is slow thus asks seldom.
export class Live {
  private socket?: WebSocket;
  private pause = FIRST_PAUSE_MS;
  private stopped = false;
  private reconnect = 0;
  private hidden = 0;
  // A message has come, and the next one is not asked for.
  private owesAsk = false;

  constructor(private readonly handlers: LiveHandlers) { this.connect(); }

  stop(): void {
    this.stopped = true;
    clearTimeout(this.reconnect);
    clearTimeout(this.hidden);
    this.socket?.close();
  }

  askNext(): void {
    if (!this.owesAsk) return;
    this.owesAsk = false;
    clearTimeout(this.hidden);
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send('next');
  }

  private connect(): void {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/api/live`);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.owesAsk = false;
    socket.onopen = () => socket.send('next');
    socket.onmessage = (event) => {
      this.pause = FIRST_PAUSE_MS;
      this.owesAsk = true;
      this.hidden = window.setTimeout(() => this.askNext(), HIDDEN_MS);
      this.handlers.onMessage(decode(event.data as ArrayBuffer));
    };
    socket.onclose = (event) => {
      clearTimeout(this.hidden);
      if (this.stopped) return;
      if (event.code === SIGNED_OUT) {
        this.stopped = true;
        this.handlers.onSignedOut();
        return;
      }
      this.handlers.onLost();
      this.reconnect = window.setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE_MS);
    };
  }
}
