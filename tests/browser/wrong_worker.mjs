// SPDX-License-Identifier: Apache-2.0
// A worker that takes a lease and delivers what is no image, until it is quarantined. It speaks gRPC by hand:
// messages of proto/tessera/v1/worker_service.proto, each behind a byte of flags and its length.
import {createHash, randomBytes} from 'node:crypto';
import http2 from 'node:http2';
import {until} from './farm.mjs';

function varint(value) {
  const bytes = [];
  for (let rest = BigInt(value); ; rest >>= 7n) {
    if (rest < 128n) return Buffer.from([...bytes, Number(rest)]);
    bytes.push(Number(rest & 127n) | 128);
  }
}

// A message of fields [number, value]: whole numbers, texts, bytes and messages.
function encode(fields) {
  return Buffer.concat(
    fields.flatMap(([number, value]) => {
      if (typeof value === 'number' || typeof value === 'bigint') return [varint(number << 3), varint(value)];
      const bytes = Buffer.from(value);
      return [varint((number << 3) | 2), varint(bytes.length), bytes];
    }),
  );
}

// The fields of a message by their numbers, each with its last value.
function decode(bytes) {
  const fields = {};
  let at = 0;
  const number = () => {
    let value = 0n;
    for (let shift = 0n; ; shift += 7n) {
      const byte = bytes[at++];
      value |= BigInt(byte & 127) << shift;
      if (byte < 128) return value;
    }
  };
  while (at < bytes.length) {
    const tag = Number(number());
    if ((tag & 7) === 0) {
      fields[tag >> 3] = number();
    } else {
      const size = (tag & 7) === 2 ? Number(number()) : (tag & 7) === 1 ? 8 : 4;
      fields[tag >> 3] = bytes.subarray(at, at + size);
      at += size;
    }
  }
  return fields;
}

// Returns {status, answer}; `answer` is empty unless the status is 0.
function call(session, method, message) {
  return new Promise((resolve, reject) => {
    const stream = session.request({
      ':method': 'POST',
      ':path': `/tessera.v1.WorkerService/${method}`,
      'content-type': 'application/grpc',
      te: 'trailers',
    });
    const parts = [];
    let status = null;
    const note = (headers) => {
      status = headers['grpc-status'] ?? status;
    };
    stream.on('response', note);
    stream.on('trailers', note);
    stream.on('data', (part) => parts.push(part));
    stream.on('error', reject);
    stream.on('end', () => resolve({status: Number(status), answer: Buffer.concat(parts).subarray(5)}));
    const head = Buffer.alloc(5);
    head.writeUInt32BE(message.length, 1);
    stream.end(Buffer.concat([head, message]));
  });
}

// Needs a job that has work. Returns the worker's id.
export async function quarantineWorker(farm, name) {
  const key = randomBytes(48);
  const id = createHash('sha256').update(key).digest('hex').slice(0, 32);
  const [fingerprint] = (await farm.api('server')).determinism_fingerprints;
  const session = http2.connect(`http://${farm.listen}`);
  const greeting = encode([
    [1, id],
    [2, name],
    [4, fingerprint],
    [5, 1],
    [7, 1],
    [13, key],
  ]);
  const lease = await until('a lease for the wrong worker', async () => {
    const {answer} = await call(session, 'Synchronize', greeting);
    const leases = decode(answer)[1];
    return leases && decode(leases);
  });
  const result = encode([
    [1, id],
    [2, lease[2]],
    [3, lease[1]],
    [4, encode([[5, 'no image']])],
    [8, fingerprint],
    [11, lease[4]],
  ]);
  await until('the quarantine', async () => {
    const {status} = await call(session, 'SubmitResult', result);
    if (status === 0) throw new Error('the result was accepted');
    return (await farm.api('quarantine')).entries.some((entry) => entry.worker_id === id);
  });
  session.close();
  return id;
}
