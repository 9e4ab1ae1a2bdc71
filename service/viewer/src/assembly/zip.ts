// A .zip of files as they are, without compression: what a person takes home.
const TABLE = Uint32Array.from({length: 256}, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c >>> 0;
});
export function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

export function zip(files: {name: string; bytes: Uint8Array}[]): Blob {
  const pieces: Uint8Array[] = [];
  const heads: Uint8Array[] = [];
  let at = 0;
  const put = (piece: Uint8Array) => {
    pieces.push(piece);
    at += piece.length;
  };
  const record = (signature: number, fields: [number, 2|4][], name: Uint8Array): Uint8Array => {
    const bytes = new Uint8Array(4 + fields.reduce((sum, [, size]) => sum + size, 0) + name.length);
    const view = new DataView(bytes.buffer);
    view.setUint32(0, signature, true);
    let place = 4;
    for (const [value, size] of fields) {
      if (size === 2)
        view.setUint16(place, value, true);
      else
        view.setUint32(place, value, true);
      place += size;
    }
    bytes.set(name, place);
    return bytes;
  };
  for (const {name, bytes} of files) {
    const text = new TextEncoder().encode(name);
    const common: [number, 2|4][] = [
      [20, 2], [0x800, 2], [0, 2], [0, 2], [0x21, 2], [crc32(bytes), 4], [bytes.length, 4], [bytes.length, 4],
      [text.length, 2], [0, 2]
    ];  // 1980-01-01, names in UTF-8
    heads.push(record(0x02014b50, [[20, 2], ...common, [0, 2], [0, 2], [0, 2], [0, 4], [at, 4]], text));
    put(record(0x04034b50, common, text));
    put(bytes);
  }
  const directory = at;
  for (const head of heads) put(head);
  put(record(
      0x06054b50,
      [[0, 2], [0, 2], [files.length, 2], [files.length, 2], [at - directory, 4], [directory, 4], [0, 2]],
      new Uint8Array()));
  return new Blob(pieces as BlobPart[], {type: 'application/zip'});
}
