// SPDX-License-Identifier: Apache-2.0
// Reads the binary stream of a job's tiles (docs/http-api.md): frames of a JSON header and a payload.
import {jobPath, open} from './api.js';

const kMaxHeader = 1 << 20,
  kMaxPayload = 1 << 26;
// Tiles that are inflated at the same time; the stream is not read any further before one is finished.
const kInflating = 16;

class ByteReader {
  constructor(body) {
    this.reader = body.getReader();
    this.chunks = [];
    this.available = 0;
  }

  // The next bytes; null at the end of the stream.
  async take(bytes) {
    while (this.available < bytes) {
      const {value, done} = await this.reader.read();
      if (done) return null;
      this.chunks.push(value);
      this.available += value.length;
    }
    this.available -= bytes;
    if (this.chunks[0]?.length > bytes) {
      const taken = this.chunks[0].subarray(0, bytes);
      this.chunks[0] = this.chunks[0].subarray(bytes);
      return taken;
    }
    return this.join(bytes);
  }

  join(bytes) {
    const taken = new Uint8Array(bytes);
    for (let at = 0; at < bytes;) {
      const part = this.chunks[0].subarray(0, bytes - at);
      taken.set(part, at);
      at += part.length;
      if (part.length === this.chunks[0].length) this.chunks.shift();
      else this.chunks[0] = this.chunks[0].subarray(part.length);
    }
    return taken;
  }
}

async function* frames(body) {
  const reader = new ByteReader(body);
  const decoder = new TextDecoder();
  while (true) {
    const sizes = await reader.take(8);
    if (!sizes) return;
    const view = new DataView(sizes.buffer, sizes.byteOffset, 8);
    const header_bytes = view.getUint32(0, true),
      payload_bytes = view.getUint32(4, true);
    if (header_bytes > kMaxHeader || payload_bytes > kMaxPayload)
      throw new Error('the tile stream is broken');
    const header = await reader.take(header_bytes);
    const payload = header && (await reader.take(payload_bytes));
    if (!payload) return;
    yield {header: JSON.parse(decoder.decode(header)), payload};
  }
}

// zlib data to half floats. All browsers run on little-endian machines. A writer costs a tenth of what pipes
// of a Blob do.
async function inflate(payload) {
  const inflater = new DecompressionStream('deflate');
  const writer = inflater.writable.getWriter();
  writer.write(payload).catch(() => {});
  writer.close().catch(() => {});
  const reader = inflater.readable.getReader();
  const parts = [];
  for (let part = await reader.read(); !part.done; part = await reader.read()) parts.push(part.value);
  return new Uint16Array(joined(parts).buffer);
}

function joined(parts) {
  if (parts.length === 1 && parts[0].byteLength === parts[0].buffer.byteLength) return parts[0];
  const whole = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

// The half floats of a frame; null if it has none.
async function halvesOf({type}, payload) {
  if (type === 'tile') return inflate(payload);
  if (type === 'tiles') return new Uint16Array(payload.slice().buffer);
  return null;
}

// Calls take(header, halves) for each of the coarse tiles that share a frame, as if it had one of its own.
function takeEach({level, tiles}, halves, take) {
  let at = 0;
  for (const [x0, y0, x1, y1, revision, samples] of tiles) {
    const size = 3 * Math.ceil((x1 - x0) / 2 ** level) * Math.ceil((y1 - y0) / 2 ** level);
    take({type: 'tile', x0, y0, x1, y1, level, revision, samples}, halves.subarray(at, at + size));
    at += size;
  }
}

// Calls handler(header, halves) for each frame in order, until the stream ends. `halves` is null except for
// tiles.
export async function readTiles(id, query, signal, handler) {
  const response = await open(jobPath(id, '/tiles'), {query: {...query, format: 'half'}, signal});
  const pending = [];
  const finish = async () => {
    const {header, halves} = pending.shift();
    const read = await halves;
    if (header.type === 'tiles') takeEach(header, read, handler);
    else handler(header, read);
  };
  for await (const {header, payload} of frames(response.body)) {
    const halves = halvesOf(header, payload);
    halves.catch(() => {});
    pending.push({header, halves});
    // A frame that is no tile ends a burst: what came before it is shown now.
    while (pending.length > (header.type === 'tile' ? kInflating : 0)) await finish();
  }
  while (pending.length > 0) await finish();
}
