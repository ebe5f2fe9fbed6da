// SPDX-License-Identifier: Apache-2.0
// Keeps the visible part of a job's image current: one live stream for the region and level that are seen,
// and short ones that fill in what comes into view. Streams resume by themselves and are closed while the
// page is hidden.
import {imageQuery} from './api.js';
import {readTiles} from './tile_stream.js';
import {TileStore, touches} from './tile_store.js';

const kFirstRetry = 250,
  kLastRetry = 4000;

export function jobWindow(job) {
  const [x0, y0, x1, y1] = job.crop ?? [0, 0, job.width, job.height];
  return {x0, y0, x1, y1};
}

const regionText = ({x0, y0, x1, y1}) => `${x0},${y0},${x1},${y1}`;
const areaOf = ({x0, y0, x1, y1}) => (x1 - x0) * (y1 - y0);
const isEmpty = ({x0, y0, x1, y1}) => x1 <= x0 || y1 <= y0;
const contains = (a, b) => a.x0 <= b.x0 && a.y0 <= b.y0 && b.x1 <= a.x1 && b.y1 <= a.y1;

// The parts of `region` outside `known`, at most four.
export function missingParts(region, known) {
  if (!known || !touches(region, known)) return [region];
  const y0 = Math.max(region.y0, known.y0),
    y1 = Math.min(region.y1, known.y1);
  return [
    {...region, y1: known.y0},
    {...region, y0: known.y1},
    {x0: region.x0, x1: known.x0, y0, y1},
    {x0: known.x1, x1: region.x1, y0, y1},
  ].filter((part) => !isEmpty(part));
}

export class ImageSource {
  // `image`: its index in the job; `layer`: the name of one, or ''. listener.changed(): something to draw;
  // listener.job(job): its newest state.
  constructor(gl, job, image, layer, listener) {
    this.id = job.id;
    this.image = image;
    this.layer = layer;
    this.window = jobWindow(job);
    this.listener = listener;
    this.store = new TileStore(gl, this.window);
    this.level = -1;
    this.region = null;
    this.covered = null; // the region whose tiles are all there, as of...
    this.revision = 0;
    this.isEnded = false; // the job is over and the image is complete
    this.parts = []; // of `covered`: those that are still to come
    this.parked = new Map(); // {covered, revision} of other levels whose pages are still there
    this.store.dropped = (dropped) => this.parked.delete(dropped);
    this.onVisibility = () => (document.hidden ? this.stop() : this.resume());
    document.addEventListener('visibilitychange', this.onVisibility);
  }

  close() {
    document.removeEventListener('visibilitychange', this.onVisibility);
    this.stop();
    this.isClosed = true;
    this.store.release();
  }

  // Whether everything of the visible region is there at its level.
  get isComplete() {
    return this.region !== null && this.hasAll(this.region);
  }

  // What is seen, in pixels of the whole image. `region` may be larger than what was asked for before.
  look(region, level) {
    if (level === this.level && this.region && contains(this.region, region)) return;
    const wanted = this.withMargin(region);
    if (this.parts.length > 0) this.covered = null;
    this.stop();
    if (level !== this.level) this.turnTo(level);
    const parts = missingParts(wanted, this.covered);
    const isAnew = parts.length === 1 && parts[0] === wanted;
    Object.assign(this, {level, region: wanted, isEnded: false});
    this.store.keep = {level, region: this.toWindow(wanted)};
    this.covered = isAnew ? null : wanted;
    this.parts = isAnew ? [] : parts;
    if (isAnew) this.revision = 0;
    this.resume();
  }

  // What is there of this level, from when it was seen before.
  turnTo(level) {
    const {covered, revision} = this;
    if (covered) this.parked.set(this.level, {covered, revision});
    Object.assign(this, {covered: null, revision: 0}, this.parked.get(level));
    this.parked.delete(level);
  }

  // Whether everything of a region is there at the level that was asked for.
  hasAll(region) {
    return this.parts.length === 0 && this.covered !== null && contains(this.covered, region);
  }

  // An eighth more each way, so that small movements need nothing new; aligned to blocks of the coarse pass.
  withMargin(region) {
    const mx = (region.x1 - region.x0) / 8,
      my = (region.y1 - region.y0) / 8;
    const {x0, y0, x1, y1} = this.window;
    const low = (value, from) => Math.max(from, from + Math.floor((value - from) / 64) * 64);
    return {
      x0: low(region.x0 - mx, x0),
      y0: low(region.y0 - my, y0),
      x1: Math.min(x1, Math.ceil(region.x1 + mx)),
      y1: Math.min(y1, Math.ceil(region.y1 + my)),
    };
  }

  toWindow({x0, y0, x1, y1}) {
    const {x0: left, y0: top} = this.window;
    return {x0: x0 - left, y0: y0 - top, x1: x1 - left, y1: y1 - top};
  }

  // The job goes on after its end: more samples were asked for.
  reopen() {
    if (!this.isEnded) return;
    this.isEnded = false;
    this.stop();
    this.resume();
  }

  stop() {
    clearTimeout(this.timer);
    this.running?.abort();
    this.running = null;
  }

  resume() {
    if (this.running || this.isClosed || document.hidden || !this.region) return;
    this.running = new AbortController();
    const {signal} = this.running;
    for (const part of this.parts) this.fill(part, signal);
    this.follow(signal, kFirstRetry);
  }

  async follow(signal, retry) {
    const query = this.query(this.region, this.revision);
    let heard = false;
    const error = await readTiles(this.id, query, signal, (header, halves) => {
      if (signal.aborted) return;
      heard = true;
      this.take(header, halves);
      if (header.type === 'revision' || header.type === 'end') this.caughtUp(header);
    }).catch((failure) => failure);
    if (signal.aborted || this.isEnded) return;
    this.listener.failed?.(error);
    if ([401, 403, 404].includes(error?.status)) return;
    const wait = heard ? kFirstRetry : retry;
    this.timer = setTimeout(
      () => !signal.aborted && this.follow(signal, Math.min(2 * wait, kLastRetry)),
      wait,
    );
  }

  query(region, since) {
    return {level: this.level, region: regionText(region), since, ...imageQuery(this.image, this.layer)};
  }

  caughtUp(header) {
    if (header.type === 'revision') this.revision = header.revision;
    if (header.type === 'end') this.isEnded = true;
    // A revision alone says from where to resume.
    if (header.whole || header.type === 'end') this.covered = this.region;
    this.listener.changed();
  }

  // For what is newly in view: a stream that ends when it has all that the live stream does not send.
  async fill(part, outer) {
    const own = new AbortController();
    const signal = AbortSignal.any([outer, own.signal]);
    const needed = this.revision;
    const query = this.query(part, 0);
    let isDone = false;
    await readTiles(this.id, query, signal, (header, halves) => {
      if (signal.aborted) return;
      if (header.type === 'tile') this.take(header, halves);
      isDone = header.type === 'end' || (header.type === 'revision' && header.revision >= needed);
      if (isDone) own.abort();
    }).catch(() => {});
    if (outer.aborted) return;
    if (!isDone) return void setTimeout(() => !outer.aborted && this.fill(part, outer), kFirstRetry);
    this.parts = this.parts.filter((other) => other !== part);
    this.listener.changed();
  }

  take(header, halves) {
    if (header.type === 'job') this.listener.job(header.job);
    if (header.type !== 'tile') return;
    this.store.put(this.level, header, halves);
    this.listener.changed();
  }
}

// A copy of the whole image at this moment, at the finest level that has at most so many texels: rejects if it
// cannot be fetched. `spp`: the samples per pixel that are in it.
export async function takeSnapshot(gl, job, {image, layer, texels}, signal) {
  const window = jobWindow(job);
  const level = Math.min(6, Math.max(0, Math.ceil(Math.log2(areaOf(window) / texels) / 2)));
  const store = new TileStore(gl, window);
  const own = new AbortController();
  const both = AbortSignal.any([signal, own.signal]);
  const samples = new Map(); // of each tile's pixels together, by its corner
  let taken = job;
  let isDone = false;
  try {
    const query = {level, region: regionText(window), since: 0, ...imageQuery(image, layer)};
    await readTiles(job.id, query, both, (header, halves) => {
      if (both.aborted) return;
      if (header.type === 'job') taken = header.job;
      if (header.type === 'tile' && header.level === level) {
        store.put(level, header, halves);
        samples.set(`${header.x0},${header.y0}`, header.samples * areaOf(header));
      }
      isDone = header.type === 'end' || Boolean(header.whole);
      if (isDone) own.abort();
    });
    if (!isDone) throw new Error('The connection was lost before the image was complete.');
  } catch (error) {
    if (!isDone) {
      store.release();
      throw error;
    }
  }
  const spp = [...samples.values()].reduce((sum, each) => sum + each, 0) / areaOf(window);
  return {store, level, job: taken, spp, at: new Date()};
}
