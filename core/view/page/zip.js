// SPDX-License-Identifier: Apache-2.0
// Reads zip archives (PKWARE APPNOTE 6.3.10) without unpacking more than is asked for: stored and deflated
// entries, also in the zip64 format.

const kEnd = 0x06054b50,
  kEnd64 = 0x06064b50,
  kLocator64 = 0x07064b50,
  kEntry = 0x02014b50;
const kMaxEntries = 100000;

class Zip extends Error {}
const broken = (why) => new Zip(`The zip archive is broken (${why}).`);

async function bytesOf(blob, from, to) {
  return new DataView(await blob.slice(from, to).arrayBuffer());
}

const u64 = (view, at) => view.getUint32(at, true) + 2 ** 32 * view.getUint32(at + 4, true);

async function findDirectory(blob) {
  const from = Math.max(0, blob.size - 65557);
  const tail = await bytesOf(blob, from, blob.size);
  let at = tail.byteLength - 22;
  while (at >= 0 && tail.getUint32(at, true) !== kEnd) at -= 1;
  if (at < 0) throw broken('it has no end');
  const directory = {
    entries: tail.getUint16(at + 10, true),
    size: tail.getUint32(at + 12, true),
    offset: tail.getUint32(at + 16, true),
  };
  const locator = at - 20;
  if (locator < 0 || tail.getUint32(locator, true) !== kLocator64) return directory;
  const end = u64(tail, locator + 8);
  const end64 = await bytesOf(blob, end, end + 56);
  if (end64.byteLength < 56 || end64.getUint32(0, true) !== kEnd64) throw broken('its zip64 end is missing');
  return {entries: u64(end64, 32), size: u64(end64, 40), offset: u64(end64, 48)};
}

function decodeName(bytes) {
  try {
    return new TextDecoder('utf-8', {fatal: true}).decode(bytes);
  } catch {
    return new TextDecoder('windows-1252').decode(bytes);
  }
}

// The 64-bit sizes of an entry, from its extra field, in the place of those that are full.
function widen(entry, view, from, to) {
  for (let at = from; at + 4 <= to;) {
    const id = view.getUint16(at, true),
      size = view.getUint16(at + 2, true);
    let value = at + 4;
    if (id === 1) {
      for (const key of ['size', 'packedSize', 'offset']) {
        if (entry[key] !== 0xffffffff || value + 8 > to) continue;
        entry[key] = u64(view, value);
        value += 8;
      }
    }
    at += 4 + size;
  }
  return entry;
}

// The files of an archive: [{path, size, blob: () => Promise<Blob>}]. Rejects with an Error for the user.
export async function readZip(blob) {
  const directory = await findDirectory(blob);
  if (directory.entries > kMaxEntries) throw new Zip(`The zip archive has more than ${kMaxEntries} entries.`);
  const view = await bytesOf(blob, directory.offset, directory.offset + directory.size);
  const files = [];
  for (let at = 0, i = 0; i < directory.entries; ++i) {
    if (at + 46 > view.byteLength || view.getUint32(at, true) !== kEntry)
      throw broken('its list of files ends early');
    const [name, extra, comment] = [28, 30, 32].map((field) => view.getUint16(at + field, true));
    const path = decodeName(new Uint8Array(view.buffer, at + 46, name)).replaceAll('\\', '/');
    const entry = widen(
      {
        size: view.getUint32(at + 24, true),
        packedSize: view.getUint32(at + 20, true),
        offset: view.getUint32(at + 42, true),
        method: view.getUint16(at + 10, true),
        isEncrypted: (view.getUint16(at + 8, true) & 1) !== 0,
      },
      view,
      at + 46 + name,
      at + 46 + name + extra,
    );
    if (!path.endsWith('/')) files.push({path, size: entry.size, blob: () => unpack(blob, path, entry)});
    at += 46 + name + extra + comment;
  }
  return files;
}

async function unpack(blob, path, {size, packedSize, offset, method, isEncrypted}) {
  if (isEncrypted) throw new Zip(`${path} is encrypted in the zip archive.`);
  if (method !== 0 && method !== 8) throw new Zip(`${path} is compressed by a method other than deflate.`);
  const local = await bytesOf(blob, offset, offset + 30);
  if (local.byteLength < 30) throw broken(`${path} is missing`);
  const from = offset + 30 + local.getUint16(26, true) + local.getUint16(28, true);
  const packed = blob.slice(from, from + packedSize);
  const unpacked = method === 0 ? packed : await inflate(packed, path, size);
  if (unpacked.size !== size) throw broken(`${path} ends early`);
  return unpacked;
}

async function inflate(packed, path, size) {
  let left = size;
  const limit = new TransformStream({
    transform(chunk, controller) {
      left -= chunk.length;
      if (left < 0) controller.error(broken(`${path} is larger than it says`));
      else controller.enqueue(chunk);
    },
  });
  const stream = packed.stream().pipeThrough(new DecompressionStream('deflate-raw')).pipeThrough(limit);
  try {
    return await new Response(stream).blob();
  } catch (error) {
    throw error instanceof Zip ? error : broken(`${path} cannot be unpacked`);
  }
}
