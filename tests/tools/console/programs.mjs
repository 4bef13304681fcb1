// Starts the project's programs for a test, and ends those that it started.

import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { setTimeout as sleep } from 'node:timers/promises';

export class Programs {
  folder = mkdtempSync(join(tmpdir(), 'tactus-page-'));
  running = new Set();
  // Those that console() started, the newest last.
  consoles = [];

  // `name`: a program of the build, or the whole path of another one.
  start(name, ...flags) {
    const program = spawn(resolve(process.env.TACTUS_BIN, name), flags,
      { stdio: ['ignore', 'pipe', 'inherit'] });
    this.running.add(program);
    program.once('exit', () => this.running.delete(program));
    return program;
  }

  // Resolves when the program has done its work; rejects if it fails.
  run(name, ...flags) {
    const program = this.start(name, ...flags);
    program.stdout.resume();
    return new Promise((resolve, reject) => program.once('exit', (code) =>
      code === 0 ? resolve() :
        reject(new Error(`${name} ${flags.join(' ')} ends with ${code}`))));
  }

  // Resolves with the first line that `pattern` matches.
  line(program, pattern) {
    const lines = createInterface({ input: program.stdout });
    return new Promise((resolve, reject) => {
      lines.on('line', (line) => {
        const match = pattern.exec(line);
        if (match) resolve(match);
      });
      program.once('exit', () => reject(new Error('the program ended')));
    });
  }

  // A server that listens.
  async server(socket, ...flags) {
    const program = this.start('tactusd', `--listen=unix:${socket}`,
      '--log-level=error', ...flags);
    program.stdout.resume();
    while (!existsSync(socket)) {
      if (!this.running.has(program)) throw new Error('tactusd ended');
      await sleep(50);
    }
    return program;
  }

  robot(socket, name, ...flags) {
    const program = this.start('tactus-stream', `--server=unix:${socket}`,
      '--driver=sim', '--rate=real', '--trials=100000', `--client-id=${name}`,
      ...flags);
    program.stdout.resume();
    return program;
  }

  // Returns the console's address.
  async console(socket, ...flags) {
    const program = this.start('tactus-console', `--server=unix:${socket}`,
      '--listen=127.0.0.1:0', ...flags);
    this.consoles.push(program);
    const match = await this.line(program, /^console: (http\S+)$/);
    program.stdout.resume();
    return match[1];
  }

  async stop(program) {
    if (program.exitCode !== null || program.signalCode !== null) return;
    const gone = new Promise((resolve) => program.once('exit', resolve));
    program.kill('SIGTERM');
    await gone;
  }

  async stopAll() {
    await Promise.all([...this.running].map((program) => this.stop(program)));
    rmSync(this.folder, { recursive: true });
  }
}
