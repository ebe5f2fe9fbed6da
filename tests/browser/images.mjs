// SPDX-License-Identifier: Apache-2.0
// Reads the image files that Tessera writes: OpenEXR (scan lines, ZIP or uncompressed) as the bits of half
// floats, and 8-bit PNG as RGB.
import zlib, {inflateSync} from 'node:zlib';

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

// The value of the bits of a half float.
export function halfValue(half) {
  const sign = half & 0x8000 ? -1 : 1,
    exponent = (half >>> 10) & 31,
    fraction = half & 0x3ff;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1024 + fraction) * 2 ** (exponent - 25);
}

// A linear value from 0 to 1 as sRGB has it.
const encode = (value) => {
  const v = Math.max(0, Math.min(1, value));
  return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
};

// The 8-bit colour of a linear one.
export const srgb = (rgb) => rgb.map((value) => Math.round(255 * encode(value)));

export const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// The largest difference of the colours `shown` from those that `expected(x, y)` returns.
export function largestDifference(shown, width, expected) {
  let largest = 0;
  for (let i = 0; i < shown.length; i += 3) {
    const pixel = i / 3;
    expected(pixel % width, Math.floor(pixel / width)).forEach((value, c) => {
      largest = Math.max(largest, Math.abs(shown[i + c] - value));
    });
  }
  return largest;
}

// The linear value of each pixel of an image that readExr() returns.
export const linearAt =
  ({width, halves}) =>
  (x, y) =>
    [0, 1, 2].map((c) => halfValue(halves[3 * (y * width + x) + c]));

// Reads a tile stream of level 0 (docs/http-api.md): calls take(tile, halves) for each tile until the stream
// ends or `signal` ends it.
export async function readTileStream(address, signal, take) {
  const {body} = await fetch(address, {signal});
  let bytes = Buffer.alloc(0);
  for await (const chunk of body) {
    bytes = Buffer.concat([bytes, chunk]);
    while (bytes.length >= 8) {
      const start = 8 + bytes.readUInt32LE(0),
        end = start + bytes.readUInt32LE(4);
      if (bytes.length < end) break;
      const header = JSON.parse(bytes.toString('utf8', 8, start));
      if (header.type === 'tile' && header.level === 0) {
        const pixels = inflateSync(bytes.subarray(start, end));
        take(header, Array.from({length: pixels.length / 2}, (_, i) => pixels.readUInt16LE(2 * i)));
      }
      bytes = bytes.subarray(end);
    }
  }
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

// A chunk of a PNG file.
function chunk(type, data) {
  const body = Buffer.concat([Buffer.from(type, 'latin1'), data]);
  const ends = Buffer.alloc(8);
  ends.writeUInt32BE(data.length, 0);
  ends.writeUInt32BE(crc32(body), 4);
  return Buffer.concat([ends.subarray(0, 4), body, ends.subarray(4)]);
}

const kHeadBytes = 33; // signature and IHDR

// The PNG file with a text in its head.
export function withText(png, keyword, text) {
  const added = chunk('iTXt', Buffer.from(`${keyword}\0\0\0\0\0${text}`));
  return Buffer.concat([png.subarray(0, kHeadBytes), added, png.subarray(kHeadBytes)]);
}

// The text that withText() has put there; null if there is none.
export function textOf(png, keyword) {
  const size = png.readUInt32BE(kHeadBytes);
  const [found, , , , , ...text] = png.toString('utf8', kHeadBytes + 8, kHeadBytes + 8 + size).split('\0');
  return png.toString('latin1', kHeadBytes + 4, kHeadBytes + 8) === 'iTXt' && found === keyword
    ? text.join('\0')
    : null;
}

// A zip archive of [name, bytes], without compression of those whose name ends with ".png".
export function writeZip(files) {
  const parts = [],
    directory = [];
  let offset = 0;
  for (const [name, bytes] of files) {
    const isStored = name.endsWith('.png');
    const packed = isStored ? bytes : zlib.deflateRawSync(bytes);
    const fields = Buffer.alloc(26);
    fields.writeUInt16LE(20, 0);
    fields.writeUInt16LE(0x800, 2);
    fields.writeUInt16LE(isStored ? 0 : 8, 4);
    fields.writeUInt32LE(crc32(bytes), 10);
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

// zlib has it from node 22 on.
function crc32(bytes) {
  if (zlib.crc32) return zlib.crc32(bytes);
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}
