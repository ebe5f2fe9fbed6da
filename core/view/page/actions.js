// SPDX-License-Identifier: Apache-2.0
// Changes of jobs: what ends or loses something asks before; the rest can be undone.
import {whyNot} from './access.js';
import {get, jobPath, patch, post, remove} from './api.js';
import {askNumber, confirm, toast, toastError} from './dialogs.js';
import {h} from './dom.js';
import {jobTitle, plural} from './format.js';
import {store} from './store.js';

const kMaxSpp = 4294967295;

function named(jobs) {
  return jobs.length === 1 ? jobTitle(jobs[0]) : plural(jobs.length, 'job');
}

// Calls `change` for each job that allows the action; tells how many it was, and every error. Returns those
// that changed.
async function changeEach(jobs, action, change) {
  const possible = jobs.filter((job) => !whyNot(action, job));
  const results = await Promise.allSettled(possible.map(change));
  const changed = possible.filter((job, i) => results[i].status === 'fulfilled');
  for (const result of results) {
    if (result.status === 'rejected') toastError(result.reason);
    else if (result.value?.id) store.putJob(result.value);
  }
  return changed;
}

const simple = (verb) => (job) => post(jobPath(job.id, `/${verb}`));

async function pause(jobs) {
  const changed = await changeEach(jobs, 'pause', simple('pause'));
  if (changed.length === 0) return;
  toast(`Paused ${named(changed)}`, {action: {label: 'Undo', run: () => resumeAgain(changed)}});
}

async function resumeAgain(jobs) {
  await changeEach(
    jobs.map((job) => store.jobs.get(job.id) ?? job),
    'resume',
    simple('resume'),
  );
}

async function resume(jobs) {
  const changed = await changeEach(jobs, 'resume', simple('resume'));
  if (changed.length === 0) return;
  const undo = () =>
    changeEach(
      changed.map((job) => store.jobs.get(job.id) ?? job),
      'pause',
      simple('pause'),
    );
  toast(`Resumed ${named(changed)}`, {action: {label: 'Undo', run: undo}});
}

function listNames(jobs) {
  return h(
    'ul.name-list',
    {},
    jobs.slice(0, 8).map((job) => h('li', {}, jobTitle(job))),
    jobs.length > 8 && h('li', {}, `and ${jobs.length - 8} more`),
  );
}

async function cancel(jobs) {
  const sure = await confirm(
    `Cancel ${plural(jobs.length, 'job')}?`,
    [
      listNames(jobs),
      h('p', {}, 'A cancelled job cannot be resumed. Its image so far can still be fetched.'),
    ],
    {label: jobs.length === 1 ? 'Cancel the job' : 'Cancel the jobs', isDanger: true},
  );
  if (!sure) return;
  const changed = await changeEach(jobs, 'cancel', simple('cancel'));
  if (changed.length > 0) toast(`Cancelled ${named(changed)}`);
}

async function removeJobs(jobs) {
  const sure = await confirm(
    `Delete ${plural(jobs.length, 'job')}?`,
    [listNames(jobs), h('p', {}, 'The samples and the image are lost. This cannot be undone.')],
    {label: 'Delete', isDanger: true},
  );
  if (!sure) return;
  const changed = await changeEach(jobs, 'delete', (job) => remove(jobPath(job.id)));
  for (const job of changed) store.forgetJob(job.id);
  if (changed.length > 0) toast(`Deleted ${named(changed)}`);
  if (changed.some((job) => location.hash.startsWith(`#/jobs/${job.id}`))) location.hash = '#/';
}

async function extend(jobs) {
  const most = Math.max(...jobs.map((job) => job.spp));
  const spp = await askNumber(`Extend ${named(jobs)}`, {
    label: 'Samples per pixel, in all',
    value: Math.min(kMaxSpp, 2 * most),
    min: most + 1,
    max: kMaxSpp,
    hint:
      `Now ${most}. Four times as many halve the noise. The image becomes that of a job submitted with ` +
      'the higher number.',
    accept: 'Extend',
  });
  if (spp === null) return;
  const changed = await changeEach(jobs, 'extend', (job) => post(jobPath(job.id, '/extend'), {spp}));
  if (changed.length > 0) toast(`Extended ${named(changed)} to ${spp} samples per pixel`);
}

async function setPriority(jobs) {
  const priority = await askNumber(`Priority of ${named(jobs)}`, {
    label: 'Priority',
    value: jobs[0].priority,
    min: -1000000,
    max: 1000000,
    hint: 'Jobs of higher priority are served first; jobs of equal priority share the farm.',
    accept: 'Set the priority',
  });
  if (priority === null) return;
  const before = new Map(jobs.map((job) => [job.id, job.priority]));
  const changed = await changeEach(jobs, 'priority', (job) => patch(jobPath(job.id), {priority}));
  const undo = () =>
    changeEach(changed, 'priority', (job) => patch(jobPath(job.id), {priority: before.get(job.id)}));
  if (changed.length > 0)
    toast(`Priority of ${named(changed)}: ${priority}`, {action: {label: 'Undo', run: undo}});
}

export const kActions = [
  {name: 'pause', label: 'Pause', icon: 'pause', run: pause},
  {name: 'resume', label: 'Resume', icon: 'resume', run: resume},
  {name: 'extend', label: 'Extend…', icon: 'extend', run: extend},
  {name: 'priority', label: 'Priority…', icon: 'priority', run: setPriority},
  {name: 'cancel', label: 'Cancel…', icon: 'cancel', run: cancel, isDanger: true},
  {name: 'delete', label: 'Delete…', icon: 'delete', run: removeJobs, isDanger: true},
];

// The items of a job's menu, for menuButton().
export function jobMenu(job) {
  return kActions.map((action) => ({
    label: action.label,
    icon: action.icon,
    isDanger: action.isDanger,
    reason: whyNot(action.name, job),
    run: () => action.run([job]),
  }));
}
