// SPDX-License-Identifier: Apache-2.0
// Sends a bundle to the coordinator and submits it as a job. Files that the coordinator has are not sent
// again.
import {get, jobPath, post, upload} from './api.js';

const kConcurrent = 3;
// Larger files are sent without asking first: the browser can hash only what fits in memory.
const kMaxHashedBytes = 1 << 30;
const kPollMs = 400;

async function sha256(blob) {
  // Browsers hash on https and on this machine only.
  if (!globalThis.crypto?.subtle || blob.size > kMaxHashedBytes) return null;
  const digest = await crypto.subtle.digest('SHA-256', await blob.arrayBuffer());
  return [...new Uint8Array(digest)].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

// The files of the bundle without repetitions, as [{file, sha256, bytes, paths}].
async function prepare(bundle, progress) {
  const blobs = new Map();
  for (const {path, file} of bundle) {
    if (!blobs.has(file)) {
      progress('Reading files', blobs.size, bundle.length);
      const blob = await file.blob();
      blobs.set(file, {blob, bytes: blob.size, sha256: await sha256(blob), paths: []});
    }
    blobs.get(file).paths.push(path);
  }
  return [...blobs.values()];
}

async function findMissing(blobs) {
  const known = blobs.filter((blob) => blob.sha256);
  if (known.length === 0) return blobs;
  const {missing} = await post('blobs/missing', {
    files: known.map(({sha256: digest, bytes}) => ({sha256: digest, bytes})),
  });
  const lacking = new Set(missing);
  return blobs.filter((blob) => !blob.sha256 || lacking.has(blob.sha256));
}

async function sendAll(blobs, progress, signal) {
  const total = blobs.reduce((sum, blob) => sum + blob.bytes, 0);
  const sent = new Map();
  const report = () =>
    progress(
      'Uploading',
      [...sent.values()].reduce((sum, bytes) => sum + bytes, 0),
      total,
    );
  const queue = [...blobs];
  const work = async () => {
    for (let blob = queue.shift(); blob; blob = queue.shift()) {
      const answer = await upload('blobs', blob.blob, {
        signal,
        onprogress: (bytes) => {
          sent.set(blob, Math.min(bytes, blob.bytes));
          report();
        },
      });
      sent.set(blob, blob.bytes);
      report();
      blob.sha256 = answer.sha256;
    }
  };
  await Promise.all(Array.from({length: kConcurrent}, work));
}

function randomId() {
  return [...crypto.getRandomValues(new Uint8Array(16))]
    .map((byte) => byte.toString(16).padStart(2, '0'))
    .join('');
}

// Resolves to the job as soon as it is stored; the scene is validated afterwards. progress(what, done,
// total).
export async function submitBundle(bundle, scenePath, options, progress, signal) {
  const blobs = await prepare(bundle, progress);
  await sendAll(await findMissing(blobs), progress, signal);
  progress('Submitting', 1, 1);
  const files = blobs
    .flatMap(({paths, sha256: digest, bytes}) => paths.map((path) => ({path, sha256: digest, bytes})))
    .sort((a, b) => (a.path < b.path ? -1 : 1));
  const request = {request_id: randomId(), scene_path: scenePath, files, ...options};
  try {
    return await post('jobs', request, {signal});
  } catch (error) {
    // The coordinator has just removed a file.
    if (error.missing?.length === 0 || error.status !== 412) throw error;
    const lacking = new Set(error.missing);
    await sendAll(
      blobs.filter((blob) => lacking.has(blob.sha256)),
      progress,
      signal,
    );
    return post('jobs', request, {signal});
  }
}

// Resolves to the job when its scene is validated: it runs, or has failed.
export async function untilValidated(job, signal) {
  let newest = job;
  while (newest.state === 'validating' && !signal.aborted) {
    await new Promise((resolve) => {
      setTimeout(resolve, kPollMs);
    });
    newest = await get(jobPath(job.id), {signal}).catch((error) => {
      if (error.status >= 400 && error.status < 500) throw error;
      return newest;
    });
  }
  return newest;
}
