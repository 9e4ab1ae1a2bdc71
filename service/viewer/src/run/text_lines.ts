// Splits a download into lines without ever holding more than a piece and an unfinished line.

/**
 * Calls `take` with each line's bytes (no end of line) and the offset where it begins. A last line without
 * its end counts only if `whole`.
 */
export class LineSplitter {
  private rest = new Uint8Array(0);
  private offset = 0;
  constructor(private readonly take: (line: Uint8Array, offset: number) => void) {}

  push(piece: Uint8Array): void {
    let bytes = piece;
    if (this.rest.length > 0) {
      bytes = new Uint8Array(this.rest.length + piece.length);
      bytes.set(this.rest);
      bytes.set(piece, this.rest.length);
    }
    let begin = 0;
    for (let end = bytes.indexOf(10); end >= 0; end = bytes.indexOf(10, begin)) {
      this.take(bytes.subarray(begin, end), this.offset + begin);
      begin = end + 1;
    }
    this.rest = bytes.slice(begin);
    this.offset += begin;
  }
  finish(): void {
    if (this.rest.length > 0) this.take(this.rest, this.offset);
    this.rest = new Uint8Array(0);
  }
}

/** Feeds a response's body to the splitter; `progress` gets the bytes so far. */
export async function split_lines(
    response: Response, take: (line: Uint8Array, offset: number) => void,
    progress: (bytes: number) => void): Promise<void> {
  const splitter = new LineSplitter(take);
  const reader = response.body?.getReader();
  if (!reader) return;
  let bytes = 0;
  for (;;) {
    const {done, value} = await reader.read();
    if (done) break;
    splitter.push(value);
    progress((bytes += value.length));
  }
  splitter.finish();
}
