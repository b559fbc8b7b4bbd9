// Texts by their paths as a zip archive, which holds them as they are.

const CRC = Uint32Array.from({ length: 256 }, (_, byte) => {
  let rest = byte;
  for (let bit = 0; bit < 8; bit++) rest = rest & 1 ? (rest >>> 1) ^ 0xedb88320 : rest >>> 1;
  return rest;
});

function checksum(bytes) {
  let rest = -1;
  for (const byte of bytes) rest = (rest >>> 8) ^ CRC[(rest ^ byte) & 255];
  return ~rest >>> 0;
}

// Numbers of so many bytes each, the least first.
const packed = (...pairs) => Uint8Array.from(pairs.flatMap(([size, value]) =>
  Array.from({ length: size }, (_, i) => Math.floor(value / 256 ** i) % 256)));

function zipped(texts) {
  const UTF8 = 0x800, FIRST_DAY = 0x21, VERSION = 20, coder = new TextEncoder();
  const parts = [], entries = [];
  const length = (some) => some.reduce((total, part) => total + part.length, 0);
  for (const [path, text] of Object.entries(texts)) {
    const name = coder.encode(path), bytes = coder.encode(text), at = length(parts), size = [4, bytes.length];
    const about = [[2, VERSION], [2, UTF8], [2, 0], [2, 0], [2, FIRST_DAY], [4, checksum(bytes)], size, size];
    const named = [[2, name.length], [2, 0]];
    parts.push(packed([4, 0x04034b50], ...about, ...named), name, bytes);
    const where = [[2, 0], [2, 0], [2, 0], [4, 0], [4, at]];
    entries.push(packed([4, 0x02014b50], [2, VERSION], ...about, ...named, ...where), name);
  }
  const count = [2, entries.length / 2];
  const end = packed([4, 0x06054b50], [2, 0], [2, 0], count, count, [4, length(entries)], [4, length(parts)], [2, 0]);
  const all = [...parts, ...entries, end], archive = new Uint8Array(length(all));
  all.reduce((at, part) => (archive.set(part, at), at + part.length), 0);
  return archive;
}
