// Which devices can be started on a scene. A replay needs the file that it replays, and only a scene can name
// one.
import type {Device, Scene} from '../server/protocol.js';

export function offered_devices(devices: readonly Device[], scene: Pick<Scene, 'driver'>): Device[] {
  return devices.filter((device) => device.kind === 'haptic')
      .map(
          (device) =>
              (device.name === 'replay' && scene.driver !== 'replay' ? {
                ...device,
                usable: false,
                reason: 'the scene names no recorded trace.csv ("device": {"driver": "replay", "path": …})'
              } :
                                                                       device));
}
