// The page's connection to its console.

import { decode, type Decoded } from './messages';

export interface Session {
  signed_in: boolean;
  needs_token: boolean;
  csrf: string;
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
  // Called with each message; the next one is asked for after it has returned
  // and the page has been drawn.
  onMessage: (decoded: Decoded) => void;
  onLost: () => void;
  onSignedOut: (reason: string) => void;
}

// Watches the robots until stop(); connects again after a loss.
export class Live {
  private socket?: WebSocket;
  private pause = FIRST_PAUSE_MS;
  private stopped = false;
  private timer = 0;

  constructor(private readonly handlers: LiveHandlers) { this.connect(); }

  stop(): void {
    this.stopped = true;
    clearTimeout(this.timer);
    this.socket?.close();
  }

  private connect(): void {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/api/live`);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => socket.send('next');
    socket.onmessage = (event) => {
      this.pause = FIRST_PAUSE_MS;
      this.handlers.onMessage(decode(event.data as ArrayBuffer));
      this.askAfterDrawing(socket);
    };
    socket.onclose = (event) => {
      if (this.stopped) return;
      if (event.code === SIGNED_OUT) {
        this.stopped = true;
        this.handlers.onSignedOut(event.reason);
        return;
      }
      this.handlers.onLost();
      this.timer = window.setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE_MS);
    };
  }

  private askAfterDrawing(socket: WebSocket): void {
    let asked = false;
    const ask = () => {
      if (asked || socket.readyState !== WebSocket.OPEN) return;
      asked = true;
      socket.send('next');
    };
    requestAnimationFrame(ask);
    window.setTimeout(ask, HIDDEN_MS);
  }
}
