// SPDX-License-Identifier: Apache-2.0
// What the page knows of the farm, kept up to date by its events. 'change' is dispatched at most once a
// frame, 'connection' when the connection is lost or restored.
import {get} from './api.js';
import {LiveEvents} from './live.js';

// As the coordinator keeps it.
const kHistorySeconds = 3 * 3600,
  kPeriodSeconds = 10;
const kListedAtOnce = 200;

class FarmStore extends EventTarget {
  constructor() {
    super();
    this.jobs = new Map();
    this.workers = new Map();
    this.session = {open: true, principal: null, role: ''};
    this.server = {features: [], limits: {}};
    this.connection = 'connecting';
    this.isLoaded = false;
    this.nextPage = ''; // of the list of jobs
    this.hasOlderJobs = false; // whether that has jobs which are not here
    this.unconfirmed = new Set(); // jobs from before a reset of which nothing has been heard since
    this.startListing();
    this.history = []; // totals(): one for each period, and that of this second
    this.periodEnds = 0;
  }

  get isLocal() {
    return this.server.features.includes('local');
  }

  connect() {
    this.live?.close();
    this.live = new LiveEvents({
      event: (name, data) => this.apply(name, data ?? {}),
      connection: (state) => this.setConnection(state),
    });
    clearInterval(this.sampling);
    this.sampling = setInterval(() => this.sampleHistory(), 1000);
  }

  disconnect() {
    this.live?.close();
    this.live = null;
    clearInterval(this.sampling);
    this.startListing();
    this.unconfirmed = new Set();
    this.jobs.clear();
    this.workers.clear();
    this.history = [];
    this.isLoaded = false;
  }

  setConnection(state) {
    if (this.connection === state) return;
    this.connection = state;
    if (state === 'live' && !this.isLocal) this.fetchHistory();
    this.dispatchEvent(new Event('connection'));
  }

  apply(name, data) {
    if (name === 'reset') {
      // Jobs are shown until the list says that they are no more: no row goes and comes back.
      this.unconfirmed = new Set(this.jobs.keys());
      this.workers.clear();
      this.fetchNewestJobs();
    } else if (name === 'jobs') {
      for (const job of data.jobs) this.putJob(job);
    } else if (name === 'workers') {
      for (const worker of data.workers) this.workers.set(worker.id, worker);
    } else if (name === 'removed') {
      for (const id of data.jobs ?? []) this.forgetJob(id);
      for (const id of data.workers ?? []) this.workers.delete(id);
    }
    this.changed();
  }

  // From events or from answers; an older state never replaces a newer one.
  putJob(job) {
    const known = this.unconfirmed.delete(job.id) ? null : this.jobs.get(job.id);
    if (known && known.revision > job.revision) return;
    this.jobs.set(job.id, job);
    this.changed();
  }

  // Events tell of unfinished jobs and of changes. Finished ones are in the list, newest first.
  async fetchNewestJobs() {
    const {unconfirmed} = this; // another one after a later reset
    this.nextPage = '';
    this.hasOlderJobs = false;
    // If the list cannot be had now, there may be more in it.
    await this.fetchOlderJobs().catch(() => {
      this.hasOlderJobs = true;
    });
    if (unconfirmed !== this.unconfirmed) return;
    for (const id of unconfirmed) this.jobs.delete(id);
    unconfirmed.clear();
    this.isLoaded = true;
    this.changed();
  }

  // The next page of the list.
  async fetchOlderJobs() {
    const listing = this.startListing();
    const page = await get('jobs', {query: {page_size: kListedAtOnce, page_token: this.nextPage}});
    if (listing !== this.listing) return;
    for (const job of page.jobs) if (!listing.removed.has(job.id)) this.putJob(job);
    this.nextPage = page.next_page_token;
    this.hasOlderJobs = this.nextPage !== '';
  }

  // The answer to an earlier request for a page comes too late. `removed`: jobs that this one may still have.
  startListing() {
    this.listing = {removed: new Set()};
    return this.listing;
  }

  forgetJob(id) {
    this.listing.removed.add(id);
    this.jobs.delete(id);
    this.changed();
  }

  changed() {
    if (this.pending) return;
    this.pending = true;
    setTimeout(() => {
      this.pending = false;
      this.dispatchEvent(new Event('change'));
    }, 60);
  }

  totals() {
    const running = [...this.jobs.values()].filter((job) => job.state === 'running');
    const workers = [...this.workers.values()].filter((worker) => worker.state !== 'silent');
    return {
      rate: running.reduce((sum, job) => sum + job.samples_per_second, 0),
      running: running.filter((job) => !job.queue_position).length,
      queued: running.filter((job) => job.queue_position).length,
      working: workers.filter((worker) => worker.held_leases > 0).length,
      workers: workers.length,
      threads: workers.reduce((sum, worker) => sum + worker.threads, 0),
    };
  }

  sampleHistory() {
    if (!this.isLoaded || this.connection !== 'live') return;
    const now = performance.now();
    if (now < this.periodEnds) this.history.pop();
    else this.periodEnds = now + 1000 * kPeriodSeconds;
    this.history.push(this.totals());
    if (this.history.length > kHistorySeconds / kPeriodSeconds) this.history.shift();
    this.dispatchEvent(new Event('history'));
  }

  // What the coordinator has seen, unless that is less: before the page was opened, or while it was hidden.
  async fetchHistory() {
    const {samples} = await get('activity').catch(() => ({samples: []}));
    if (samples.length < this.history.length) return;
    this.history = samples.map(([rate, working, running]) => ({rate, working, running, queued: 0}));
    this.periodEnds = 0;
    this.dispatchEvent(new Event('history'));
  }
}

export const store = new FarmStore();

// Listens until the returned function is called.
export function onStore(type, listener) {
  store.addEventListener(type, listener);
  return () => store.removeEventListener(type, listener);
}
