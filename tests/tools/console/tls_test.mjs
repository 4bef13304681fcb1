// The console with TLS on both sides: browsers speak https and wss to it, and
// it speaks TLS to its server.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { request } from 'node:https';
import { join } from 'node:path';
import { test } from 'node:test';
import { connect } from 'node:tls';

import { browserOf } from './browser.mjs';
import { Programs } from './programs.mjs';

const programs = new Programs();
const at = (name) => join(programs.folder, name);
const port = 20_000 + (process.pid % 10_000);
const browser = await browserOf(programs);

const makeCertificate = () =>
  execFileSync(
    'openssl',
    [
      ...'req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256'.split(' '),
      ...'-nodes -days 2 -subj /CN=localhost -addext'.split(' '),
      'subjectAltName=DNS:localhost,IP:127.0.0.1',
      ...['-keyout', at('key.pem'), '-out', at('certificate.pem')],
    ],
    { stdio: 'ignore' },
  );

// {status, headers}; refuses a certificate that it does not know.
const ask = (url, options = {}, body = '') =>
  new Promise((resolve, reject) =>
    request(url, { ca: readFileSync(at('certificate.pem')), ...options })
      .on('response', (response) => {
        response.resume();
        resolve({ status: response.statusCode, headers: response.headers });
      })
      .on('error', reject)
      .end(body),
  );

const speaks = (address, version) =>
  new Promise((resolve) => {
    const socket = connect({
      port: address.port,
      host: address.hostname,
      rejectUnauthorized: false,
      minVersion: version,
      maxVersion: version,
      // The newest OpenSSL speaks the old versions on this level alone.
      ciphers: 'DEFAULT@SECLEVEL=0',
    });
    socket.on('secureConnect', () => resolve(true));
    socket.on('error', () => resolve(false));
  });

test('browsers and server are reached by TLS', async () => {
  makeCertificate();
  const maker = programs.start(
    'trainctl',
    ...['tokens', 'create', '--name=ann', '--role=viewer'],
    `--file=${at('tokens')}`,
  );
  const [token] = await programs.line(maker, /^\S+$/);
  await programs.server(
    at('s.sock'),
    `--listen=localhost:${port}`,
    `--tls-cert=${at('certificate.pem')}`,
    `--tls-key=${at('key.pem')}`,
    `--tokens=${at('tokens')}`,
  );
  const console_ = programs.start(
    'tactus-console',
    `--server=localhost:${port}`,
    `--tls-ca=${at('certificate.pem')}`,
    '--listen=127.0.0.1:0',
    `--tls-certificate=${at('certificate.pem')}`,
    `--tls-key=${at('key.pem')}`,
  );
  const [, text] = await programs.line(console_, /^console: (https\S+)$/);
  const address = new URL(text);

  const page = await ask(address);
  assert.equal(page.status, 200);
  const signIn = await ask(
    new URL('/api/sign-in', address),
    { method: 'POST', headers: { Origin: address.origin } },
    JSON.stringify({ token }),
  );
  assert.equal(signIn.status, 200);
  assert.match(signIn.headers['set-cookie'][0], /; Secure/);
  assert.equal(await speaks(address, 'TLSv1.1'), false);
  assert.equal(await speaks(address, 'TLSv1.2'), true);
  assert.equal(await speaks(address, 'TLSv1.3'), true);
  // Who speaks http there gets no page.
  await assert.rejects(fetch(`http://${address.host}/`));

  const person = await browser.newPage({ ignoreHTTPSErrors: true });
  const sockets = [];
  person.on('websocket', (socket) => sockets.push(socket.url()));
  await person.goto(address.href);
  await person.getByRole('textbox').fill(token);
  await person.keyboard.press('Enter');
  await person.getByText('No robot').first().waitFor();
  assert.deepEqual(sockets, [`wss://${address.host}/api/live`]);
});
