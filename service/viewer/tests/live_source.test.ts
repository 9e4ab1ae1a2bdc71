// A session's stream: the tool is shown where contact holds it, not where the device has gone.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {LiveSource} from '../src/live_source.js';
import type {Moment} from '../src/moment.js';
import type {Api} from '../src/server/api.js';

const at = (z: number) => [0, 0, z, 0, 0, 0, 1];
const message = (device: number, tool: number|null) => ({
  type: 'telemetry',
  pose: at(device),
  force: [0, 0, 0],
  torque: [0, 0, 0],
  frame: tool === null ? null : {tick: 1, areas: [], contact: true},
  frame_pose: tool === null ? null : at(tool),
});

test('the tool is drawn at the newest frame’s pose, which messages without a frame keep', () => {
  const socket = {onmessage: (_event: {data: string}): void => undefined};
  const moments: Moment[] = [];
  new LiveSource(
      {socket: () => socket} as unknown as Api, 'one', (moment) => moments.push(moment), () => undefined);
  for (const [device, tool] of [[0.1, null], [0, 0.05], [-0.01, null], [-0.02, 0.049]] as const)
    socket.onmessage({data: JSON.stringify(message(device, tool))});
  assert.deepEqual(moments.map((moment) => moment.pose[2]), [0.1, 0.05, 0.05, 0.049]);
});
