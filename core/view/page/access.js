// SPDX-License-Identifier: Apache-2.0
// Which actions the caller may take. The server decides; the page explains beforehand.
import {isOver, jobTitle} from './format.js';
import {store} from './store.js';

// Each returns null, or the reason why not.
const kStateRules = {
  pause: (job) => (job.state === 'running' ? null : 'Only a running job can be paused.'),
  resume: (job) => (job.state === 'paused' ? null : 'Only a paused job can be resumed.'),
  cancel: (job) => (isOver(job) ? 'The job is over already.' : null),
  extend: (job) =>
    ['running', 'paused', 'done'].includes(job.state)
      ? null
      : 'Only a running, paused or done job can be extended.',
  priority: (job) => (isOver(job) ? 'The job is over: its priority has no effect.' : null),
  delete: () => null,
};

export function whyNotSubmit() {
  const {open, principal, role} = store.session;
  if (store.isLocal) return 'This page shows a local render.';
  if (open || role === 'admin' || role === 'submit') return null;
  if (!principal) return 'Log in to make changes.';
  return `The role of ${principal} (${role || 'none'}) does not allow changes to jobs.`;
}

export function whyNotChange(job) {
  const reason = whyNotSubmit();
  const {open, principal, role} = store.session;
  if (reason || open || role === 'admin' || job.owner === principal) return reason;
  return `Only ${job.owner || 'its owner'} and administrators can change this job.`;
}

export function whyNotAdmin() {
  const {open, role} = store.session;
  if (store.isLocal) return 'This page shows a local render.';
  return open || role === 'admin' ? null : 'Only administrators can do this.';
}

export function whyNot(action, job) {
  return whyNotChange(job) ?? kStateRules[action](job);
}

// For several jobs: possible if it is possible for one of them.
export function whyNotAll(action, jobs) {
  if (jobs.length === 0) return 'Select jobs first.';
  const reasons = jobs.map((job) => whyNot(action, job));
  if (reasons.includes(null)) return null;
  return jobs.length === 1 ? reasons[0] : `${jobTitle(jobs[0])}: ${reasons[0]}`;
}
