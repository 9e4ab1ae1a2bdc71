// Where a picture's time goes: what each kind of process has used of the processors (Linux, /proc), among the
// children of this one: chromium's by their --type, others by their name.
import {readdirSync, readFileSync} from 'node:fs';
import {basename} from 'node:path';

const TICKS_A_SECOND = 100;  // of /proc on every Linux that chromium runs on

/** Processor time so far, ms, by kind of process. */
export function processor_times() {
  const found = new Map();
  for (const pid of readdirSync('/proc').filter((name) => /^\d+$/.test(name))) {
    try {
      const stat = readFileSync(`/proc/${pid}/stat`, 'utf8');
      const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');  // the name before it may hold blanks
      const line = readFileSync(`/proc/${pid}/cmdline`, 'utf8')
                       .replaceAll('\0', ' ');  // chromium's processes write theirs with blanks
      found.set(Number(pid), {
        parent: Number(fields[1]),
        ms: ((Number(fields[11]) + Number(fields[12])) * 1000) / TICKS_A_SECOND,
        kind: /--type=([a-z-]+)/.exec(line)?.[1] ?? basename(line.split(' ')[0])
      });
    } catch { /* it has ended meanwhile */
    }
  }
  const ours = (pid) => {
    for (let at = pid, i = 0; at > 1 && i < 20; at = found.get(at)?.parent ?? 0, ++i)
      if (at === process.pid) return true;
    return false;
  };
  const sums = {};
  for (const [pid, {kind, ms}] of found)
    if (pid !== process.pid && ours(pid)) sums[kind] = (sums[kind] ?? 0) + ms;
  return sums;
}

/** What was used since `before`, ms a picture, by kind; what is less than a tenth is left out. */
export function used_since(before, pictures) {
  const now = processor_times();
  return Object.fromEntries(
      Object.entries(now)
          .map(([kind,
                 ms]) => [kind, Math.round((10 * (ms - (before[kind] ?? 0))) / Math.max(1, pictures)) / 10])
          .filter(([, ms]) => ms >= 0.1));
}
