// SPDX-License-Identifier: Apache-2.0
// The HTTP API (docs/http-api.md), relative to the page, so that a proxy may put both below a prefix.

const kBase = 'api/v1/';

export class ApiError extends Error {
  constructor(status, error) {
    super(error.message || `the server answered with status ${status}`);
    this.status = status;
    this.code = error.code ?? '';
    this.field = error.field ?? '';
    this.missing = error.missing ?? [];
  }
}

// Called when a request lacks valid credentials.
let onUnauthenticated = () => {};
export function setUnauthenticatedHandler(handler) {
  onUnauthenticated = handler;
}

export function url(path, query = {}) {
  const parameters = new URLSearchParams();
  for (const [key, value] of Object.entries(query))
    if (value !== null && value !== undefined && value !== '') parameters.set(key, value);
  const text = parameters.toString();
  return kBase + path + (text && `?${text}`);
}

export function jobPath(id, rest = '') {
  return `jobs/${encodeURIComponent(id)}${rest}`;
}

// The parameters that name an image of a job, and a layer of it ('' for the beauty).
export const imageQuery = (index, layer = '') => ({image: index > 0 ? String(index) : null, layer});

export async function toError(response) {
  const body = await response.json().catch(() => ({}));
  const error = new ApiError(response.status, body.error ?? {});
  if (error.status === 401) onUnauthenticated();
  return error;
}

async function call(method, path, {query, body, signal} = {}) {
  const options = {method, signal, headers: {Accept: 'application/json'}, cache: 'no-store'};
  if (method !== 'GET') options.headers['X-Tessera'] = '1';
  if (body !== undefined) {
    options.headers['Content-Type'] = 'application/json';
    options.body = JSON.stringify(body);
  }
  let response;
  try {
    response = await fetch(url(path, query), options);
  } catch (error) {
    if (error.name === 'AbortError') throw error;
    throw new ApiError(0, {code: 'UNAVAILABLE', message: 'the coordinator does not answer'});
  }
  if (!response.ok) throw await toError(response);
  const text = await response.text();
  return text ? JSON.parse(text) : {};
}

export const get = (path, options) => call('GET', path, options);
export const post = (path, body = {}, options = {}) => call('POST', path, {...options, body});
export const patch = (path, body) => call('PATCH', path, {body});
export const remove = (path) => call('DELETE', path);

// A stream of bytes: returns the response, or throws an ApiError.
export async function open(path, {query, headers, signal}) {
  const response = await fetch(url(path, query), {headers, signal, cache: 'no-store'});
  if (!response.ok) throw await toError(response);
  return response;
}

// Sends a body with progress, which fetch() cannot report.
export function upload(path, body, {onprogress, signal}) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open('POST', url(path));
    request.setRequestHeader('X-Tessera', '1');
    request.setRequestHeader('Content-Type', 'application/octet-stream');
    request.responseType = 'json';
    request.upload.onprogress = (event) => onprogress(event.loaded);
    request.onload = () => {
      if (request.status >= 200 && request.status < 300) return resolve(request.response);
      if (request.status === 401) onUnauthenticated();
      return reject(new ApiError(request.status, request.response?.error ?? {}));
    };
    request.onerror = () => reject(new ApiError(0, {message: 'the connection broke during the upload'}));
    request.onabort = () => reject(new DOMException('aborted', 'AbortError'));
    signal?.addEventListener('abort', () => request.abort());
    request.send(body);
  });
}
