// SPDX-License-Identifier: Apache-2.0
// The server-sent events of the farm, read with fetch(): unlike EventSource, it tells a missing login from a
// coordinator that restarts, and its retries are ours. Resumes after the last event; closed while the page is
// hidden.
import {open} from './api.js';

const kFirstRetry = 250,
  kLastRetry = 5000;
// Three keep-alives.
const kSilence = 45000;

// Calls event(name, data) for each event of the text stream.
async function readEvents(body, heard, event) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = '';
  while (true) {
    const {value, done} = await reader.read();
    if (done) return;
    heard();
    rest += value;
    const blocks = rest.split(/\r?\n\r?\n/);
    rest = blocks.pop();
    for (const block of blocks) readBlock(block, event);
  }
}

function readBlock(block, event) {
  const fields = {event: 'message', data: [], id: null};
  for (const line of block.split(/\r?\n/)) {
    const colon = line.indexOf(':');
    if (colon <= 0) continue;
    const name = line.slice(0, colon),
      value = line.slice(colon + 1).replace(/^ /, '');
    if (name === 'data') fields.data.push(value);
    else if (name === 'event' || name === 'id') fields[name] = value;
  }
  event(fields.event, fields.data.length > 0 ? JSON.parse(fields.data.join('\n')) : null, fields.id);
}

export class LiveEvents {
  // listener.event(name, data); listener.connection('live' | 'reconnecting' | 'paused').
  constructor(listener) {
    this.listener = listener;
    this.lastId = null;
    this.retry = kFirstRetry;
    this.onVisibility = () => (document.hidden ? this.pause() : this.start());
    document.addEventListener('visibilitychange', this.onVisibility);
    if (!document.hidden) this.start();
  }

  close() {
    document.removeEventListener('visibilitychange', this.onVisibility);
    this.pause();
  }

  pause() {
    clearTimeout(this.timer);
    this.running?.abort();
    this.running = null;
    this.listener.connection('paused');
  }

  start() {
    if (this.running) return;
    clearTimeout(this.timer);
    const controller = new AbortController();
    this.running = controller;
    this.read(controller)
      .catch((error) => error)
      .then((error) => {
        clearTimeout(this.watchdog);
        if (this.running !== controller) return;
        this.running = null;
        if (error?.status === 401) return;
        this.listener.connection('reconnecting');
        this.timer = setTimeout(() => this.start(), this.retry * (0.75 + Math.random() / 2));
        this.retry = Math.min(2 * this.retry, kLastRetry);
      });
  }

  async read(controller) {
    const headers = {Accept: 'text/event-stream'};
    if (this.lastId) headers['Last-Event-ID'] = this.lastId;
    const response = await open('events', {headers, signal: controller.signal});
    const heard = () => {
      clearTimeout(this.watchdog);
      this.watchdog = setTimeout(() => controller.abort(), kSilence);
    };
    heard();
    this.retry = kFirstRetry;
    this.listener.connection('live');
    await readEvents(response.body, heard, (name, data, id) => {
      if (this.running !== controller) return;
      this.listener.event(name, data);
      if (id !== null) this.lastId = id;
    });
  }
}
