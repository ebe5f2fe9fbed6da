// SPDX-License-Identifier: Apache-2.0
// Numbers, times and states as text.

export function count(value) {
  if (!Number.isFinite(value)) return '–';
  const units = ['', ' k', ' M', ' G', ' T', ' P'];
  let unit = 0;
  while (Math.abs(value) >= 999.5 && unit + 1 < units.length) {
    value /= 1000;
    unit += 1;
  }
  const digits = unit === 0 ? (Number.isInteger(value) ? 0 : 1) : value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
  return value.toFixed(digits) + units[unit];
}

// Without a unit, for columns whose heading has it; "–" for none.
export function rate(value) {
  return value > 0 ? count(value) : '–';
}

// The samples per second of a job: none once it has stopped.
export function speedOf(job) {
  return job.state === 'running' ? job.samples_per_second : 0;
}

export function bytes(value) {
  const text = count(value);
  return /[0-9]$/.test(text) ? `${text} B` : `${text}B`;
}

export function percent(part, whole) {
  if (!(whole > 0)) return '0 %';
  const value = Math.min(100, (100 * part) / whole);
  if (value > 0 && value < 0.1) return '< 0.1 %';
  // 100 % only when nothing is left.
  const shown = part < whole ? Math.min(99.9, value) : value;
  return `${shown >= 99.95 || shown === 0 ? shown.toFixed(0) : shown.toFixed(1)} %`;
}

export function duration(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return '–';
  if (seconds < 1) return '< 1 s';
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  if (whole < 48 * 3600) return `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
  return `${Math.floor(whole / 86400)} d ${Math.floor((whole % 86400) / 3600)} h`;
}

export function ago(time) {
  if (!time) return '–';
  const seconds = (Date.now() - Date.parse(time)) / 1000;
  if (!Number.isFinite(seconds)) return '–';
  if (seconds < 5) return 'now';
  if (seconds < 60) return `${Math.floor(seconds / 5) * 5} s ago`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  if (seconds < 86400) return `${Math.floor(seconds / 3600)} h ago`;
  return `${Math.floor(seconds / 86400)} d ago`;
}

export function localTime(time) {
  const date = new Date(time);
  if (!time || Number.isNaN(date.getTime())) return '–';
  const pad = (n) => String(n).padStart(2, '0');
  return (
    `${date.getFullYear()}-${pad(date.getMonth() + 1)}-${pad(date.getDate())} ` +
    `${pad(date.getHours())}:${pad(date.getMinutes())}:${pad(date.getSeconds())}`
  );
}

export function shortId(id) {
  return id.slice(0, 12);
}

export function plural(number, singular, many = `${singular}s`) {
  return `${number} ${number === 1 ? singular : many}`;
}

// A linear value with four significant digits.
export function light(value) {
  if (value === 0) return '0';
  if (!Number.isFinite(value)) return String(value);
  const magnitude = Math.abs(value);
  if (magnitude >= 1e5 || magnitude < 1e-4) return value.toExponential(2);
  return value.toPrecision(4);
}

export function stops(value) {
  return `${value > 0 ? '+' : value < 0 ? '−' : ''}${Math.abs(value)
    .toFixed(2)
    .replace(/\.?0+$/, '')}`;
}

export function jobTitle(job) {
  return job.name || shortId(job.id);
}

export function timeLeft(job) {
  if (job.state === 'running') {
    if (job.queue_position) return `queued, ${ordinal(job.queue_position)}`;
    return duration(job.seconds_left);
  }
  return '–';
}

function ordinal(n) {
  const tens = n % 100;
  const suffix = tens >= 11 && tens <= 13 ? 'th' : (['th', 'st', 'nd', 'rd'][n % 10] ?? 'th');
  return `${n}${suffix}`;
}

// A job that has no worker yet is running for the farm and queued for people.
export function shownState(job) {
  return job.state === 'running' && job.queue_position ? 'queued' : job.state;
}

export function isOver(job) {
  return job.state === 'done' || job.state === 'cancelled' || job.state === 'failed';
}
