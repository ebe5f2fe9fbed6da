// SPDX-License-Identifier: Apache-2.0
// Reads the image files that Tessera writes: OpenEXR (scan lines, ZIP or uncompressed) as the bits of half
// floats, and 8-bit PNG as RGB.
import {inflateSync} from 'node:zlib';

const kFloat = new Float32Array(1);
const kBits = new Uint32Array(kFloat.buffer);

// The bits of the nearest half float, ties to even; too large ones become the largest.
export function nearestHalf(value) {
  kFloat[0] = value;
  const bits = kBits[0],
    sign = (bits >>> 16) & 0x8000,
    magnitude = bits & 0x7fffffff;
  if (magnitude >= 0x477ff000) return sign | 0x7bff;
  if (magnitude < 0x33000001) return sign;
  const exponent = magnitude >>> 23;
  const shift = exponent < 113 ? 126 - exponent : 13;
  const whole = exponent < 113 ? (magnitude & 0x7fffff) | 0x800000 : magnitude - (112 << 23);
  const rest = whole & ((1 << shift) - 1),
    half = 1 << (shift - 1);
  const down = whole >>> shift;
  return sign | (down + (rest > half || (rest === half && down & 1) ? 1 : 0));
}

function readHeader(bytes) {
  const attributes = {};
  let at = 8;
  const text = () => {
    const end = bytes.indexOf(0, at);
    const value = bytes.toString('latin1', at, end);
    at = end + 1;
    return value;
  };
  for (let name = text(); name !== ''; name = text()) {
    text(); // the type
    const size = bytes.readUInt32LE(at);
    attributes[name] = bytes.subarray(at + 4, at + 4 + size);
    at += 4 + size;
  }
  return {attributes, at};
}

function readChannels(bytes) {
  const channels = [];
  for (let at = 0; bytes[at] !== 0;) {
    const end = bytes.indexOf(0, at);
    channels.push({name: bytes.toString('latin1', at, end), isHalf: bytes.readUInt32LE(end + 1) === 1});
    at = end + 17;
  }
  return channels;
}

// Reverses OpenEXR's ZIP: differences, and even bytes before odd ones.
function unzip(packed, size) {
  if (packed.length === size) return packed;
  const bytes = inflateSync(packed);
  for (let i = 1; i < bytes.length; ++i) bytes[i] = (bytes[i - 1] + bytes[i] - 128) & 255;
  const whole = Buffer.alloc(size),
    middle = (size + 1) >> 1;
  for (let i = 0; i < size; ++i) whole[i] = bytes[(i >> 1) + (i & 1 ? middle : 0)];
  return whole;
}

// {width, height, x0, y0, halves}: R, G, B of each pixel, row by row.
export function readExr(bytes) {
  const {attributes, at} = readHeader(bytes);
  const [x0, y0, x1, y1] = [0, 4, 8, 12].map((offset) => attributes.dataWindow.readInt32LE(offset));
  const width = x1 - x0 + 1,
    height = y1 - y0 + 1;
  const channels = readChannels(attributes.channels);
  const rowBytes = channels.reduce((sum, {isHalf}) => sum + width * (isHalf ? 2 : 4), 0);
  const rowsAtOnce = [1, 1, 1, 16][attributes.compression[0]];
  const halves = new Uint16Array(3 * width * height);
  for (let block = 0; block * rowsAtOnce < height; ++block) {
    const from = Number(bytes.readBigUInt64LE(at + 8 * block));
    const y = bytes.readInt32LE(from) - y0,
      rows = Math.min(rowsAtOnce, height - y);
    const packed = bytes.subarray(from + 8, from + 8 + bytes.readUInt32LE(from + 4));
    readRows(unzip(packed, rows * rowBytes), channels, {y, rows, width}, halves);
  }
  return {width, height, x0, y0, halves};
}

function readRows(bytes, channels, {y, rows, width}, halves) {
  let at = 0;
  for (let row = y; row < y + rows; ++row) {
    for (const {name, isHalf} of channels) {
      const channel = 'RGB'.indexOf(name);
      for (let x = 0; x < width; ++x, at += isHalf ? 2 : 4) {
        if (channel < 0) continue;
        halves[3 * (row * width + x) + channel] = isHalf
          ? bytes.readUInt16LE(at)
          : nearestHalf(bytes.readFloatLE(at));
      }
    }
  }
}

// {width, height, rgb} of an 8-bit RGB file without interlacing.
export function readPng(bytes) {
  const width = bytes.readUInt32BE(16),
    height = bytes.readUInt32BE(20);
  if (bytes[24] !== 8 || bytes[25] !== 2 || bytes[28] !== 0) throw new Error('not an 8-bit RGB file');
  const parts = [];
  for (let at = 8; at < bytes.length;) {
    const size = bytes.readUInt32BE(at);
    if (bytes.toString('latin1', at + 4, at + 8) === 'IDAT')
      parts.push(bytes.subarray(at + 8, at + 8 + size));
    at += 12 + size;
  }
  return {width, height, rgb: unfilter(inflateSync(Buffer.concat(parts)), 3 * width, height)};
}

function unfilter(raw, rowBytes, height) {
  const rgb = Buffer.alloc(rowBytes * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (rowBytes + 1)];
    for (let i = 0; i < rowBytes; ++i) {
      const left = i >= 3 ? rgb[y * rowBytes + i - 3] : 0;
      const up = y > 0 ? rgb[(y - 1) * rowBytes + i] : 0;
      const corner = i >= 3 && y > 0 ? rgb[(y - 1) * rowBytes + i - 3] : 0;
      const predicted = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
      rgb[y * rowBytes + i] = raw[y * (rowBytes + 1) + 1 + i] + predicted;
    }
  }
  return rgb;
}

function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// A zip archive of [name, bytes], without compression of those whose name ends with ".png".
export async function writeZip(files) {
  const {crc32, deflateRawSync} = await import('node:zlib');
  const checksum = crc32 ?? slowCrc32;
  const parts = [],
    directory = [];
  let offset = 0;
  for (const [name, bytes] of files) {
    const isStored = name.endsWith('.png');
    const packed = isStored ? bytes : deflateRawSync(bytes);
    const fields = Buffer.alloc(26);
    fields.writeUInt16LE(20, 0);
    fields.writeUInt16LE(0x800, 2);
    fields.writeUInt16LE(isStored ? 0 : 8, 4);
    fields.writeUInt32LE(checksum(bytes), 10);
    fields.writeUInt32LE(packed.length, 14);
    fields.writeUInt32LE(bytes.length, 18);
    fields.writeUInt16LE(Buffer.byteLength(name), 22);
    parts.push(Buffer.from('PK\x03\x04', 'latin1'), fields, Buffer.from(name), packed);
    const entry = Buffer.alloc(42);
    entry.writeUInt16LE(20, 0);
    fields.copy(entry, 2, 0, 24);
    entry.writeUInt32LE(offset, 38);
    directory.push(Buffer.from('PK\x01\x02', 'latin1'), entry, Buffer.from(name));
    offset += 30 + Buffer.byteLength(name) + packed.length;
  }
  const list = Buffer.concat(directory),
    end = Buffer.alloc(22);
  end.write('PK\x05\x06', 0, 'latin1');
  end.writeUInt16LE(files.length, 8);
  end.writeUInt16LE(files.length, 10);
  end.writeUInt32LE(list.length, 12);
  end.writeUInt32LE(offset, 16);
  return Buffer.concat([...parts, list, end]);
}

function slowCrc32(bytes) {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}
