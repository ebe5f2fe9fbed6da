// SPDX-License-Identifier: Apache-2.0
// A farm of real processes on free ports of this machine, ended with the test. TESSERA_BIN is the folder of
// the programs, TESSERA_SOURCE_DIR that of the sources.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {setPriority, tmpdir} from 'node:os';
import {join} from 'node:path';

const bin = process.env.TESSERA_BIN;
export const kScenes = join(process.env.TESSERA_SOURCE_DIR, 'scenes');
export const kCornell = join(kScenes, 'cornell', 'scene.json');

// A scene without files, rendered in no time.
export const glowingSphere = (width, height) => ({
  render: {width, height, spp: 4},
  camera: {position: [0, 0, 4], look_at: [0, 0, 0]},
  materials: {glow: {type: 'lambert', albedo: 0.5, emission: [2, 1, 0.5]}},
  shapes: [{type: 'sphere', radius: 1, center: [0, 0, 0], material: 'glow'}],
});

export const sleep = (ms) =>
  new Promise((resolve) => {
    setTimeout(resolve, ms);
  });

// Polls until `condition` returns something true, and returns that.
export async function until(what, condition, ms = 120000) {
  const end = Date.now() + ms;
  while (Date.now() < end) {
    const value = await condition();
    if (value) return value;
    await sleep(50);
  }
  throw new Error(`not within ${ms} ms: ${what}`);
}

// Also a test that is ended from outside leaves nothing behind.
const children = new Set();
process.once('SIGTERM', () => {
  for (const child of children) child.kill('SIGKILL');
  process.exit(1);
});

function start(program, args, environment = {}) {
  const child = spawn(join(bin, program), args, {env: {...process.env, NO_COLOR: '1', ...environment}});
  children.add(child);
  const running = {child, out: '', err: '', code: null};
  child.stdout.on('data', (data) => {
    running.out += data;
  });
  child.stderr.on('data', (data) => {
    running.err += data;
  });
  running.ended = new Promise((resolve) =>
    child.on('close', (code, signal) => {
      children.delete(child);
      running.code = code ?? signal;
      resolve(running);
    }),
  );
  return running;
}

async function end(running, signal = 'SIGTERM') {
  if (!running || running.code !== null) return;
  running.child.kill(signal);
  const timer = setTimeout(() => running.child.kill('SIGKILL'), 15000);
  await running.ended;
  clearTimeout(timer);
}

// The page of a local render: {url, close()}.
export async function startView(args) {
  const running = start('tessera', ['render', ...args, '--quiet', '--view', '127.0.0.1:0']);
  const [, url] = await until('the page is served', () => running.err.match(/the page is at (\S+)/));
  return {url, close: () => end(running, 'SIGINT')};
}

export class Farm {
  // tokens: lines of a file of tokens; environment of clients and workers is set by tessera({token}).
  static async start({workers = 1, threads = 2, tokens = null, options = []} = {}) {
    const farm = new Farm();
    farm.folder = mkdtempSync(join(tmpdir(), 'tessera-browser-'));
    farm.options = [...options];
    farm.listen = '127.0.0.1:0';
    farm.http = '127.0.0.1:0';
    if (tokens) {
      farm.tokens = tokens;
      writeFileSync(join(farm.folder, 'tokens'), tokens.map((line) => `${line}\n`).join(''), {mode: 0o600});
      farm.options.push('--tokens', join(farm.folder, 'tokens'));
    }
    farm.workers = [];
    await farm.startCoordinator();
    for (let i = 0; i < workers; ++i) farm.startWorker(`worker-${i + 1}`, threads);
    return farm;
  }

  async startCoordinator() {
    this.coordinator = start('tessera-coordinator', [
      '--listen',
      this.listen,
      '--http',
      this.http,
      '--state',
      join(this.folder, 'state'),
      '--lease-seconds',
      '2',
      ...this.options,
    ]);
    const [, listen] = await until('the coordinator listens', () => this.printed(/listening on (\S+)/));
    const [, url] = await until('the page is served', () => this.printed(/the page is at (\S+)/));
    this.listen = listen;
    this.url = url;
    this.http = new URL(url).host;
  }

  printed(pattern) {
    if (this.coordinator.code !== null) throw new Error(`the coordinator ended: ${this.coordinator.err}`);
    return this.coordinator.out.match(pattern);
  }

  async killCoordinator() {
    await end(this.coordinator, 'SIGKILL');
  }

  // A file with the token of this role, for --token-file.
  tokenFile(role) {
    const token = this.token(role);
    const file = join(this.folder, `${role}.token`);
    writeFileSync(file, `${token}\n`, {mode: 0o600});
    return file;
  }

  token(roleOrName) {
    return this.tokens
      .map((line) => line.split(/\s+/))
      .find((words) => words.slice(0, 2).includes(roleOrName))[2];
  }

  startWorker(name, threads) {
    const environment = this.tokens ? {TESSERA_TOKEN_FILE: this.tokenFile('work')} : {};
    const worker = start(
      'tessera-worker',
      [
        '--coordinator',
        this.listen,
        '--threads',
        String(threads),
        '--name',
        name,
        '--cache',
        join(this.folder, `cache-${name}`),
      ],
      environment,
    );
    // Renders that last as long as the test leave the processors to the browser.
    setPriority(worker.child.pid, 10);
    this.workers.push(worker);
    return worker;
  }

  // Runs a command to its end: {code, out, err}.
  async tessera(args, {token = null} = {}) {
    const environment = {TESSERA_COORDINATOR: this.listen};
    if (token) environment.TESSERA_TOKEN_FILE = this.tokenFile(token);
    return start('tessera', args, environment).ended;
  }

  // Submits the Cornell box and returns the job's id.
  async submit(options = [], extra = {}) {
    const {code, out, err} = await this.tessera(['submit', kCornell, ...options], extra);
    if (code !== 0) throw new Error(`tessera submit: ${err}`);
    return out.trim();
  }

  // Submits a scene (an object) over HTTP, with more fields of the request, and returns the job's id.
  async submitScene(scene, fields = {}) {
    const text = JSON.stringify(scene);
    const {sha256, bytes} = await this.api('blobs', {method: 'POST', body: text});
    const files = [{path: 'scene.json', sha256, bytes}];
    const body = JSON.stringify({scene_path: 'scene.json', files, ...fields});
    return (await this.api('jobs', {method: 'POST', body})).id;
  }

  async api(path, options = {}) {
    const response = await fetch(new URL(`api/v1/${path}`, this.url), {
      ...options,
      headers: {'X-Tessera': '1', ...options.headers},
    });
    if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
    const type = response.headers.get('content-type');
    return type?.startsWith('application/json') ? response.json() : Buffer.from(await response.arrayBuffer());
  }

  async waitForState(id, state, ms = 180000) {
    return until(
      `${id} is ${state}`,
      async () => {
        const job = await this.api(`jobs/${id}`);
        return job.state === state ? job : null;
      },
      ms,
    );
  }

  // Waits until nothing of a paused job changes: its leases have ended, and the images have all samples that
  // were counted, which reach them a moment later.
  async waitForRest(id) {
    return until(`${id} rests`, async () => {
      const job = await this.api(`jobs/${id}`);
      const ofImages = job.images.reduce((sum, image) => sum + image.samples_done, 0);
      return job.active_workers === 0 && ofImages === job.samples_done ? job : null;
    });
  }

  async pause(id) {
    await this.api(`jobs/${id}/pause`, {method: 'POST'});
    return this.waitForRest(id);
  }

  async close() {
    await Promise.all(this.workers.map((worker) => end(worker, 'SIGKILL')));
    await end(this.coordinator);
    rmSync(this.folder, {recursive: true, force: true});
  }
}
