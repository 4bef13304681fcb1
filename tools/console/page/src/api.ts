// Calls of a server, by the console. Messages are JSON of protobuf: numbers of
// 64 bits come as text.

import { readSession, type Session } from './connection';

export class ApiError extends Error {
  constructor(readonly code: string, readonly reason: string, message: string,
      readonly metadata: Record<string, string> = {}) {
    super(message);
  }

  get isDenied(): boolean { return this.reason === 'PERMISSION_DENIED'; }

  // True if the console or the server does not answer.
  get isAway(): boolean {
    return this.code === 'OFFLINE' || this.code === 'UNAVAILABLE';
  }
}

export type Role = 'robot' | 'viewer' | 'trainer' | 'admin';
const ROLES: string[] = ['robot', 'viewer', 'trainer', 'admin'];

export class Api {
  private asked?: Promise<Role | undefined>;

  // `server`: its number in the session's list.
  constructor(readonly server: number, private readonly session: Session,
      private readonly onSignedOut: () => void) {}

  get address(): string { return this.session.servers[this.server]!; }

  // The name of the person's sign-in; empty without one.
  get person(): string { return this.session.name ?? ''; }

  // `method` like "ModelService/ListAliases". Throws an ApiError.
  async call<Response>(method: string, request: object = {},
      signal?: AbortSignal): Promise<Response> {
    const response = await this.post(method, request, signal);
    if (response.ok) return await response.json() as Response;
    if (!await this.isRenewed(response)) throw await errorOf(response);
    const again = await this.post(method, request, signal);
    if (again.ok) return await again.json() as Response;
    throw await errorOf(again);
  }

  // Sends JSON or a file to the console itself; `onSent` gets how many bytes
  // are gone. Throws an ApiError.
  async send<Answer>(path: string, body: object | File, signal: AbortSignal,
      onSent: (bytes: number) => void = () => undefined): Promise<Answer> {
    const response = await this.put(path, body, signal, onSent);
    if (response.ok) return await response.json() as Answer;
    if (!await this.isRenewed(response)) throw await errorOf(response);
    const again = await this.put(path, body, signal, onSent);
    if (again.ok) return await again.json() as Answer;
    throw await errorOf(again);
  }

  // Says something to the console, also while the page is left.
  tell(path: string): void {
    void fetch(path, { method: 'POST', body: '{}', keepalive: true,
      headers: { 'X-CSRF-Token': this.session.csrf } })
      .catch(() => undefined);
  }

  // fetch() does not say how much is sent.
  private put(path: string, body: object | File, signal: AbortSignal,
      onSent: (bytes: number) => void): Promise<Response> {
    return new Promise((resolve, reject) => {
      if (signal.aborted) return reject(signal.reason);
      const request = new XMLHttpRequest();
      request.open('POST', path);
      request.setRequestHeader('X-CSRF-Token', this.session.csrf);
      request.upload.onprogress = ({ loaded }) => onSent(loaded);
      request.onload = () => resolve(new Response(request.responseText,
        { status: request.status }));
      request.onerror = () => void whyNotSent(body).then(reject);
      request.onabort = () => reject(signal.reason);
      signal.addEventListener('abort', () => request.abort(), { once: true });
      request.send(body instanceof File ? body : JSON.stringify(body));
    });
  }

  private async post(method: string, request: object, signal?: AbortSignal):
      Promise<Response> {
    try {
      return await fetch(`/api/servers/${this.server}/${method}`, {
        method: 'POST', body: JSON.stringify(request), signal: signal ?? null,
        headers: { 'Content-Type': 'application/json',
          'X-CSRF-Token': this.session.csrf },
      });
    } catch (error) {
      if (signal?.aborted) throw error;
      throw new ApiError('OFFLINE', '', 'The console does not answer.');
    }
  }

  // True if the person has signed in anew, in another window or because the
  // console was started again, and this page did not know. A server may also
  // refuse a token that another server takes.
  private async isRenewed({ status }: Response): Promise<boolean> {
    if (status !== 401 && status !== 403) return false;
    const { signed_in, csrf } = await readSession().catch(() => this.session);
    if (!signed_in) this.onSignedOut();
    const isNew = signed_in && csrf !== this.session.csrf;
    this.session.csrf = csrf;
    return isNew;
  }

  // True if the server lets the person do what needs `role`; undefined if it
  // does not say. Asked once: the refusal of what only admins may names the
  // caller's role.
  async may(role: Role): Promise<boolean | undefined> {
    this.asked ??= this.call('AdminService/GetServerInfo').then(
      (): Role => 'admin',
      (error) => error instanceof ApiError && error.isDenied ?
        error.metadata.role as Role : undefined);
    const own = await this.asked;
    if (own === undefined) this.asked = undefined;
    return own === undefined ? undefined :
      ROLES.indexOf(own) >= ROLES.indexOf(role);
  }
}

// All pages of a list; `items` is the name of the list in a response.
export async function listAll<Item>(api: Api, method: string, items: string,
    signal?: AbortSignal, most = 10, page_size = 1000): Promise<Item[]> {
  const all: Item[] = [];
  let page_token = '';
  for (let i = 0; i < most; ++i) {
    const response = await api.call<Record<string, unknown>>(method,
      { page_size, page_token }, signal);
    all.push(...response[items] as Item[]);
    page_token = response.next_page_token as string;
    if (page_token === '') break;
  }
  return all;
}

async function errorOf(response: Response): Promise<ApiError> {
  try {
    const { code, reason, message, metadata, error } = await response.json();
    return new ApiError(code ?? '', reason ?? '',
      message ?? error ?? `status ${response.status}`, metadata ?? {});
  } catch {
    return new ApiError('', '', `status ${response.status}`);
  }
}

// A browser does not say why bytes did not go.
async function whyNotSent(body: object | File): Promise<ApiError> {
  const isThere = !(body instanceof File) || await body.slice(0, 1)
    .arrayBuffer().then(() => true, () => false);
  return isThere ? new ApiError('OFFLINE', '', 'The console does not answer.') :
    new ApiError('', '', `${(body as File).name} can no longer be read: ` +
      'it has changed or gone. Choose it again.');
}

// The same request sent twice does its work once.
export function newRequestId(): string { return crypto.randomUUID(); }
