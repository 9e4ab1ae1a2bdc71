// The picture as a PNG, and as a video for as long as one wants.
import {element, write} from '../dom.js';
import type {SceneView} from '../draw/scene_view.js';
import {save_as} from '../assembly/workshop.js';

const PICTURES_A_SECOND = 30;

export class CameraShots {
  private recorder: MediaRecorder|null = null;

  constructor(
      private readonly view: SceneView, private readonly name: () => string,
      private readonly say: (text: string, bad?: boolean) => void) {
    element('screenshot').addEventListener('click', () => this.screenshot());
    element('video').addEventListener('click', () => this.video());
    element<HTMLButtonElement>('video').disabled =
        typeof MediaRecorder === 'undefined' || !('captureStream' in view.canvas);
  }
  private file(ending: string): string {
    return `${this.name().replace(/[^A-Za-z0-9._-]+/g, '_') || 'palpate'}.${ending}`;
  }
  private screenshot(): void {
    this.view.draw_now();  // what WebGL drew is gone once it is on the screen
    this.view.canvas.toBlob((blob) => {
      if (blob)
        save_as(blob, this.file('png'));
      else
        this.say('The picture can\'t be saved.', true);
    });
  }
  private video(): void {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    const type = ['video/webm;codecs=vp9', 'video/webm', 'video/mp4'].find(
        (kind) => MediaRecorder.isTypeSupported(kind));
    if (!type) {
      this.say('This browser writes no video.', true);
      return;
    }
    const pieces: Blob[] = [];
    const recorder =
        (this.recorder =
             new MediaRecorder(this.view.canvas.captureStream(PICTURES_A_SECOND), {mimeType: type}));
    recorder.ondataavailable = (event) => pieces.push(event.data);
    recorder.onstop = () => {
      this.recorder = null;
      write(element('video'), 'Video');
      element('video').setAttribute('aria-pressed', 'false');
      save_as(new Blob(pieces, {type}), this.file(type.includes('mp4') ? 'mp4' : 'webm'));
    };
    recorder.start();
    write(element('video'), 'Stop');
    element('video').setAttribute('aria-pressed', 'true');
    this.view.request();
  }
}
