// What is said while an answer is away: how long this contact takes, and on which engine.
const seconds = (ms: number): string =>
    (ms < 1000 ? `${Math.round(ms / 10) * 10} ms` : `${(ms / 1000).toFixed(1)} s`);

/**
 * `waited_ms`: since the question; `engine`: who is asked, '' if unknown; `last_ms`: what the answer before
 * took, NaN for none.
 */
export function waiting_words(waited_ms: number, engine: string, last_ms: number): string {
  const by = engine ? ` on ${engine}` : '';
  const before = Number.isFinite(last_ms) ? `; the last one took ${seconds(last_ms)}` : '';
  return `this contact takes more than ${seconds(waited_ms)}${by}${before}`;
}
