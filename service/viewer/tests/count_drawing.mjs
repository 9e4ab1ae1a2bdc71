/**
 * For a page's start (addInitScript): counts what each picture hands to WebGL and strokes on other canvases,
 * and how long the page works for it. `window.drawing.take()` gives what came since the last call.
 * `window.drawing.began`, where it is set, is asked at each picture, and its answer kept as `told`.
 */
export function count_drawing() {
  let pictures = [], tasks = [], last = NaN;
  const none = () => ({triangles: 0, uploaded: 0, strokes: 0, script: 0, drawn: false});
  let now = none();
  const wrap = (name, see, owner = WebGL2RenderingContext) => {
    const real = owner.prototype[name];
    owner.prototype[name] = function(...args) {
      see(args);
      return real.apply(this, args);
    };
  };
  wrap('stroke', () => {
    ++now.strokes;
  }, CanvasRenderingContext2D);
  const draw = (mode, count) => {
    if (!now.drawn) now.told = window.drawing.began?.();
    if (mode === WebGL2RenderingContext.TRIANGLES) {
      if (count > 3) now.triangles += count / 3;
      now.drawn = true;
    }
  };  // one alone lays down what is kept
  wrap('drawElements', ([mode, count]) => draw(mode, count));
  wrap('drawArrays', ([mode, , count]) => draw(mode, count));
  const size = (data) => (typeof data === 'number' ? data : data?.byteLength ?? 0);
  wrap('bufferData', ([, data]) => {
    now.uploaded += size(data);
  });
  wrap('bufferSubData', ([, , data, , length]) => {
    now.uploaded += length ? length * data.BYTES_PER_ELEMENT : size(data);
  });
  const frame = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (call) => frame((time) => {
    const began = performance.now();
    call(time);
    now.script += performance.now() - began;
    if (!now.drawn) return;  // another call of this frame may be the one that draws
    pictures.push({between: time - last, ...now});
    last = time;
    now = none();
  });
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) tasks.push(entry.duration);
  }).observe({entryTypes: ['longtask']});
  window.drawing = {
    take() {
      const taken = {pictures, tasks};
      pictures = [];
      tasks = [];
      last = NaN;
      now = none();
      return taken;
    }
  };
}
