// The server's HTTP endpoints. Every failure is an ApiError: a problem of the server's, or `status` 0 when
// nobody answered.
import type {Assembly, ClearanceAnswer, Device, Frame, Pose, Problem, Run, Scene, SceneList, SceneParts, Session} from './protocol.js';
import {read_geometry, read_voxels, type Body, type Geometry, type Voxels} from './binary.js';

export class ApiError extends Error {
  constructor(readonly status: number, readonly problem: Problem|null, message: string) {
    super(message);
  }
}

const TOKEN_KEY = 'palpate.token';

export class Api {
  private token: string|null = sessionStorage.getItem(TOKEN_KEY);

  get has_token(): boolean {
    return this.token !== null;
  }
  set_token(token: string): void {
    this.token = token;
    sessionStorage.setItem(TOKEN_KEY, token);
  }

  async fetch(path: string, options: {method?: string; body?: unknown; signal?: AbortSignal;
                                      range?: string} = {}): Promise<Response> {
    const headers: Record<string, string> = {};
    if (this.token) headers['Authorization'] = `Bearer ${this.token}`;
    if (options.body !== undefined) headers['Content-Type'] = 'application/json';
    if (options.range) headers['Range'] = options.range;
    let response: Response;
    try {
      response = await fetch(path, {
        method: options.method ?? 'GET',
        headers,
        cache: 'no-store',
        ...(options.body !== undefined ? {body: JSON.stringify(options.body)} : {}),
        ...(options.signal ? {signal: options.signal} : {}),
      });
    } catch (error) {
      throw new ApiError(0, null, error instanceof Error ? error.message : String(error));
    }
    if (response.ok) return response;
    let problem: Problem|null = null;
    try {
      problem = (await response.json()) as Problem;
    } catch { /* not ours: the status says enough */
    }
    throw new ApiError(
        response.status, problem, problem?.detail || problem?.title || `${path} answers ${response.status}`);
  }

  async json<T>(path: string, options: Parameters<Api['fetch']>[1] = {}): Promise<T> {
    return (await this.fetch(path, options)).json() as Promise<T>;
  }
  async bytes(path: string, signal?: AbortSignal): Promise<ArrayBuffer> {
    return (await this.fetch(path, signal ? {signal} : {})).arrayBuffer();
  }

  /** Whether the server takes requests; false also when nobody answers. */
  async alive(): Promise<boolean> {
    try {
      return (await fetch('readyz', {cache: 'no-store', signal: AbortSignal.timeout(4000)})).ok;
    } catch {
      return false;
    }
  }

  scenes(): Promise<SceneList> {
    return this.json('v1/scenes');
  }
  open_scene(path: string, ignore_initial = false, engine = ''): Promise<Scene> {
    return this.json('v1/scenes', {
      method: 'POST',
      body: {path, ...(ignore_initial ? {start: 'ignore_initial'} : {}), ...(engine ? {engine} : {})}
    });
  }
  scene_parts(id: string): Promise<SceneParts> {
    return this.json(`v1/scenes/${id}/parts`);
  }
  /** What touches at a pose, and which parts. */
  query(id: string, pose: Pose): Promise<Frame&{parts?: {static: string[]; tool: string[]}}> {
    return this.json(`v1/scenes/${id}/query?names=1`, {method: 'POST', body: {pose}});
  }
  /** How far the tool is from the mock-up at a pose, exactly. */
  clearance(id: string, pose: Pose): Promise<ClearanceAnswer> {
    return this.json(`v1/scenes/${id}/query?clearance=1`, {method: 'POST', body: {pose}});
  }
  /** The page that says whether a path is clear, where it first touches and how near it passes. */
  async path_page(id: string, poses: Pose[]): Promise<Blob> {
    return (await this.fetch(`v1/scenes/${id}/path`, {method: 'POST', body: {poses}})).blob();
  }
  scene(id: string): Promise<Scene> {
    return this.json(`v1/scenes/${id}`);
  }
  async geometry(id: string, max_triangles: number, signal?: AbortSignal): Promise<Geometry> {
    return read_geometry(await this.bytes(`v1/scenes/${id}/geometry?max_triangles=${max_triangles}`, signal));
  }
  async tool_geometry(id: string, max_triangles: number, signal?: AbortSignal): Promise<Body> {
    const asked = `v1/scenes/${id}/geometry?max_triangles=${max_triangles}&body=tool`;
    return read_geometry(await this.bytes(asked, signal)).tool;
  }
  async triangles(id: string, body: 'static'|'tool', ids: string): Promise<Float32Array> {
    return new Float32Array(await this.bytes(`v1/scenes/${id}/triangles?body=${body}&ids=${ids}`));
  }
  async voxels(id: string, kind: 'boundary'|'internal'): Promise<Voxels> {
    return read_voxels(await this.bytes(`v1/scenes/${id}/voxels?class=${kind}`));
  }

  /** Uploads files; `progress` gets 0 … 1. */
  upload(files: {name: string; blob: Blob}[], progress: (part: number) => void, signal: AbortSignal):
      Promise<Assembly> {
    const form = new FormData();
    for (const {name, blob} of files) form.append('file', blob, name);
    return new Promise((resolve, reject) => {
      const request = new XMLHttpRequest();  // fetch tells nothing of how much has been sent
      request.open('POST', 'v1/assemblies');
      if (this.token) request.setRequestHeader('Authorization', `Bearer ${this.token}`);
      request.upload.onprogress = (event) => {
        if (event.lengthComputable) progress(event.loaded / event.total);
      };
      request.onerror = () => reject(new ApiError(0, null, 'the upload broke off'));
      request.onabort = () => reject(new DOMException('cancelled', 'AbortError'));
      request.onload = () => {
        let answer: unknown = null;
        try {
          answer = JSON.parse(request.responseText);
        } catch { /* the status says enough */
        }
        if (request.status === 202)
          resolve(answer as Assembly);
        else
          reject(new ApiError(
              request.status, answer as Problem,
              (answer as Problem | null)?.detail ?? `the upload answers ${request.status}`));
      };
      signal.addEventListener('abort', () => request.abort());
      request.send(form);
    });
  }
  assembly(id: string): Promise<Assembly> {
    return this.json(`v1/assemblies/${id}`);
  }
  async assembly_geometry(id: string, max_triangles: number): Promise<Geometry> {
    return read_geometry(await this.bytes(`v1/assemblies/${id}/geometry?max_triangles=${max_triangles}`));
  }
  make_scene(id: string, order: {scene: unknown; path?: string; name: string; engine?: string}):
      Promise<Scene> {
    return this.json(`v1/assemblies/${id}/scene`, {method: 'POST', body: order});
  }
  save_scene(id: string, order: {scene: unknown; path?: string; folder: string}):
      Promise<{path: string; bytes: number}> {
    return this.json(`v1/assemblies/${id}/save`, {method: 'POST', body: order});
  }

  async devices(): Promise<Device[]> {
    return (await this.json<{devices: Device[]}>('v1/devices')).devices;
  }
  async sessions(): Promise<Session[]> {
    return (await this.json<{sessions: Session[]}>('v1/sessions')).sessions;
  }
  start(scene: string, device: string, record = ''): Promise<Session> {
    return this.json('v1/sessions', {method: 'POST', body: {scene, device, ...(record ? {record} : {})}});
  }
  pause(id: string, paused: boolean): Promise<Session> {
    return this.json(`v1/sessions/${id}/${paused ? 'pause' : 'resume'}`, {method: 'POST'});
  }
  stop(id: string): Promise<Session> {
    return this.json(`v1/sessions/${id}`, {method: 'DELETE'});
  }

  async runs(): Promise<Run[]> {
    return (await this.json<{runs: Run[]}>('v1/runs')).runs;
  }
  run_file(name: string, file: string, range?: string): Promise<Response> {
    return this.fetch(`v1/runs/${encodeURIComponent(name)}/${file}`, range ? {range} : {});
  }

  socket(path: string): WebSocket {
    const {url, protocols} = this.socket_address(path);
    return new WebSocket(url, protocols);
  }
  /** For who opens it: a WebSocket of a browser can't set headers, so the token is a protocol. */
  socket_address(path: string): {url: string; protocols: string[]} {
    const url = new URL(path, location.href);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    return {url: url.href, protocols: this.token ? ['palpate', `palpate.token.${this.token}`] : []};
  }
}
