// A console without servers: it serves the page and speaks the console's
// protocol with made-up robots.
//
//   node fake_console.mjs PAGE_DIR [ROBOTS [PORT]]   to look at it by hand

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { WebSocketServer } from 'ws';

import { makeRobots } from './fake_robot.mjs';

const POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; " +
  "img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; " +
  "form-action 'self'; frame-ancestors 'none'";
const TYPES = { 'index.html': 'text/html; charset=utf-8',
  'app.js': 'text/javascript; charset=utf-8',
  'app.css': 'text/css; charset=utf-8', 'favicon.svg': 'image/svg+xml' };
const FRAME_MS = 1000 / 30;
const LONGEST_SILENCE_MS = 1000;
const SIGNED_OUT = 4401;

export class FakeConsole {
  // `token`: what lets people in; none if everybody may see the robots.
  constructor(pageDir, robots, { token } = {}) {
    this.pageDir = pageDir;
    this.robots = robots;
    this.token = token;
    this.signedIn = token === undefined;
    this.state = 'connected';
    this.error = '';
    // What requests of pages get, by their paths: functions of the body.
    this.answers = {};
    this.browsers = new Set();
    this.started = performance.now();
    this.steps = 0;
    this.http = createServer((request, response) => {
      this.serve(request, response).catch((error) => {
        response.writeHead(500).end(String(error));
      });
    });
    this.sockets = new WebSocketServer({ noServer: true });
    this.http.on('upgrade', (request, socket, head) => {
      this.sockets.handleUpgrade(request, socket, head, (browser) =>
        this.welcome(browser));
    });
  }

  async listen(port = 0) {
    await new Promise((resolve) =>
      this.http.listen(port, '127.0.0.1', resolve));
    this.timer = setInterval(() => this.step(), FRAME_MS / 2);
    this.port = this.http.address().port;
    this.url = `http://127.0.0.1:${this.port}/`;
    return this.url;
  }

  async close() {
    clearInterval(this.timer);
    this.drop();
    this.http.closeAllConnections();
    await new Promise((resolve) => this.http.close(resolve));
  }

  // Ends all connections of pages, as a console that is stopped.
  drop() {
    for (const { socket } of this.browsers) socket.terminate();
  }

  // Ends all sign-ins.
  signOut() {
    this.signedIn = false;
    for (const { socket } of this.browsers) socket.close(SIGNED_OUT);
  }

  // The server of the robots goes, or returns and names them anew.
  setServer(state, error = '') {
    this.state = state;
    this.error = error;
    for (const browser of this.browsers) browser.seen.clear();
    this.tell(true);
  }

  end(robot) {
    robot.ended = true;
    robot.number += 0.5;
  }

  // As many frames as the clock asks for: a busy machine delays timers.
  step() {
    const due = Math.floor((performance.now() - this.started) / FRAME_MS);
    if (due <= this.steps) return;
    this.steps = due;
    for (const robot of this.robots) robot.step();
    this.tell(false);
  }

  tell(always) {
    for (const browser of this.browsers) this.answer(browser, always);
  }

  async serve(request, response) {
    response.setHeader('Content-Security-Policy', POLICY);
    response.setHeader('Cache-Control', 'no-store');
    const route = `${request.method} ${request.url}`;
    const json = (status, value) => response.writeHead(status,
      { 'Content-Type': 'application/json' }).end(JSON.stringify(value));
    if (route === 'GET /api/session') return json(200, this.session());
    if (route === 'POST /api/sign-in') {
      let body = '';
      for await (const chunk of request) body += chunk;
      this.signedIn = JSON.parse(body).token === this.token;
      return this.signedIn ? json(200, this.session()) : json(401, {
        error: 'the token is unknown <img src=x onerror="window.hacked=1">' });
    }
    if (route === 'POST /api/sign-out') {
      this.signedIn = request.headers['x-csrf-token'] !== 'csrf-1';
      return response.writeHead(this.signedIn ? 403 : 204).end();
    }
    const answer = this.answers[request.url.split('?')[0]];
    if (answer) {
      let body = '';
      for await (const chunk of request) body += chunk;
      return json(200, await answer(body));
    }
    const name = request.url === '/' ? 'index.html' : request.url.slice(1);
    if (!(name in TYPES)) return json(404, { error: 'no such page' });
    const bytes = await readFile(join(this.pageDir, name));
    response.writeHead(200, { 'Content-Type': TYPES[name] }).end(bytes);
  }

  session() {
    return { signed_in: this.signedIn, name: this.token ? 'lab' : '',
      needs_token: this.token !== undefined, csrf: 'csrf-1',
      watch_key: this.signedIn ? 'watch-1' : '', servers: ['127.0.0.1:50051'] };
  }

  welcome(socket) {
    if (!this.signedIn) return socket.close(SIGNED_OUT);
    // `seen`: frames and events of each robot that the page has.
    const browser = { socket, seen: new Map(), asked: false, first: true };
    this.browsers.add(browser);
    socket.on('close', () => this.browsers.delete(browser));
    socket.on('message', (data) => {
      if (String(data) !== 'next' || browser.asked) {
        this.faults = (this.faults ?? 0) + 1;
        return;
      }
      browser.asked = true;
      browser.timer = setTimeout(() => this.answer(browser, true),
        LONGEST_SILENCE_MS);
      this.answer(browser, false);
    });
  }

  // Sends what is new, if the page has asked and there is something.
  answer(browser, always) {
    if (!browser.asked) return;
    const taxels = [];
    const updates = this.state !== 'connected' ? [] :
      this.robots.flatMap((robot) => this.update(browser, robot, taxels));
    if (updates.length === 0 && !always && !browser.first) return;
    browser.first = false;
    browser.asked = false;
    clearTimeout(browser.timer);
    const servers = [{ address: '127.0.0.1:50051', state: this.state,
      error: this.error }];
    let text = JSON.stringify({ servers, updates,
      console_time_ms: Date.now(), waited_us: 400 });
    const length = Math.ceil(Buffer.byteLength(text) / 4) * 4;
    text += ' '.repeat(length - Buffer.byteLength(text));
    const head = Buffer.alloc(4);
    head.writeUInt32LE(length);
    browser.socket.send(Buffer.concat([head, Buffer.from(text),
      ...taxels.map((part) => Buffer.from(part.buffer))]));
  }

  update(browser, robot, taxels) {
    const seen = browser.seen.get(robot);
    if (seen && seen.number === robot.number) return [];
    if (!seen && robot.ended) return [];
    const begin = taxels.reduce((sum, part) => sum + part.length, 0);
    const hasFrame = robot.frame && !robot.ended;
    if (hasFrame) taxels.push(robot.frame.taxels);
    browser.seen.set(robot,
      { number: robot.number, events: robot.events.length });
    return [{
      server: 0, taxels: hasFrame ? begin : -1,
      update: { stream_id: robot.id, ...(seen ? {} :
        { opened: robot.opened() }), counts: robot.counts(),
      ...(hasFrame ? { frame: robot.frame.json } : {}),
      events: robot.events.slice(seen ? seen.events : -64),
      events_left_out: '0', ended: robot.ended },
    }];
  }
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [pageDir, robots = '4', port = '0'] = process.argv.slice(2);
  const fake = new FakeConsole(pageDir, makeRobots(Number(robots)));
  console.log(await fake.listen(Number(port)));
}
