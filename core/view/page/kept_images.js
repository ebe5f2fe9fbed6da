// SPDX-License-Identifier: Apache-2.0
// Earlier states of a job's image, for comparison: snapshots that somebody took, and moments that the page
// keeps by itself while it shows the job. Both are bounded in number and size; the oldest of a kind give way.
import {takeSnapshot} from './image_source.js';

const kMaxSnapshots = 4,
  kMaxMoments = 6;
const kSnapshotTexels = 4.5e6,
  kMomentTexels = 2.1e6; // 17 MB on the graphics card, at most
// A moment is kept whenever there are so many times the samples of the last one.
const kMomentFactor = 2;
const kRetryMs = 10000;

export class KeptImages {
  constructor(viewer) {
    this.viewer = viewer;
    this.all = []; // {id, isMoment, image, layer, store, level, job, spp, at}, newest first
    this.lastId = 0;
    this.nextTry = 0;
    this.generation = 0; // raised when the graphics card has lost everything
  }

  // Those of the image and layer that are shown.
  shown() {
    const {image, layer} = this.viewer;
    return this.all.filter((kept) => kept.image === image && kept.layer === layer);
  }

  get(id) {
    return this.all.find((kept) => kept.id === id);
  }

  takeSnapshot(job) {
    return this.take(job, {isMoment: false, texels: kSnapshotTexels, most: kMaxSnapshots});
  }

  // Whether there is a new moment, of which a later state of the job is expected.
  async keepMoment(job) {
    if (this.isTaking || document.hidden || performance.now() < this.nextTry) return false;
    const last = this.shown().find((kept) => kept.isMoment);
    const least = last ? kMomentFactor * last.spp : 1;
    if (job.state !== 'running' || !(sppOf(job, this.viewer.image) >= least)) return false;
    this.isTaking = true;
    try {
      await this.take(job, {isMoment: true, texels: kMomentTexels, most: kMaxMoments});
      return true;
    } catch {
      this.nextTry = performance.now() + kRetryMs;
      return false;
    } finally {
      this.isTaking = false;
    }
  }

  async take(job, {isMoment, texels, most}) {
    const {generation} = this;
    const {gl, image, layer} = this.viewer;
    const taken = await takeSnapshot(gl, job, {image, layer, texels}, AbortSignal.timeout(60000));
    if (this.viewer.isClosed || this.generation !== generation) {
      taken.store.release();
      throw new Error('The snapshot was lost with the view.');
    }
    this.lastId += 1;
    const kept = {...taken, id: `kept ${this.lastId}`, isMoment, image, layer};
    this.all.unshift(kept);
    // The one that is compared with stays.
    const others = this.all.filter((each) => each.isMoment === isMoment && each !== this.viewer.other);
    for (const old of others.slice(most)) {
      old.store.release();
      this.all.splice(this.all.indexOf(old), 1);
    }
    return kept;
  }

  // After the graphics card has lost all of them.
  forget() {
    this.generation += 1;
    this.all = [];
  }
}

// The samples per pixel that an image of a job has got, as far as they are known.
function sppOf(job, image) {
  const {samples_done, samples_total} = job.image_count > 1 ? (job.images?.[image] ?? {}) : job;
  return (job.spp * samples_done) / samples_total;
}
