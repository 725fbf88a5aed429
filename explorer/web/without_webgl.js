// Runs before viser's page (1.1.1). Where the browser has no WebGL, as on remote desktops and locked-down machines, viser
// shows nothing at all: its messages are handled inside the 3-D picture. Here every canvas then gets a context that draws
// nothing, so that plots, controls and verdict work, and a sentence says what is missing. With WebGL it does nothing.
(() => {
  const real = HTMLCanvasElement.prototype.getContext;
  const works = () => {
    try { return real.call(document.createElement('canvas'), 'webgl2') !== null; } catch (refused) { return false; }
  };
  if (works()) return;
  const names = window.WebGL2RenderingContext || {};
  const parameter = name => {
    if (name === names.VERSION) return 'WebGL 2.0';
    if (name === names.SHADING_LANGUAGE_VERSION) return 'WebGL GLSL ES 3.00';
    if (name === names.VENDOR || name === names.RENDERER) return 'none';
    if (name === names.VIEWPORT || name === names.SCISSOR_BOX) return new Int32Array([0, 0, 1, 1]);
    return 1024;
  };
  const counted = [names.ACTIVE_UNIFORMS, names.ACTIVE_ATTRIBUTES, names.ACTIVE_UNIFORM_BLOCKS];
  const answers = {
    getParameter: parameter,
    getExtension: () => null,
    getSupportedExtensions: () => [],
    getContextAttributes: () => ({alpha: true, depth: true, stencil: false, antialias: false}),
    getShaderPrecisionFormat: () => ({precision: 23, rangeMin: 127, rangeMax: 127}),
    getProgramParameter: (_, name) => counted.includes(name) ? 0 : true,
    getShaderParameter: () => true,
    getProgramInfoLog: () => '',
    getShaderInfoLog: () => '',
    getAttribLocation: () => -1,
    getUniformLocation: () => null,
    getUniformBlockIndex: () => 4294967295,
    checkFramebufferStatus: () => names.FRAMEBUFFER_COMPLETE,
    clientWaitSync: () => names.ALREADY_SIGNALED,
    getError: () => 0,
    isContextLost: () => false,
  };
  const nothing = canvas => new Proxy({canvas, ...answers}, {
    get: (known, name) => {
      if (name in known) return known[name];
      if (typeof name !== 'string') return undefined;
      if (name === 'drawingBufferWidth') return canvas.width;
      if (name === 'drawingBufferHeight') return canvas.height;
      if (/^[A-Z0-9_]+$/.test(name)) return names[name];
      return name.startsWith('create') ? () => ({}) : () => undefined;
    },
  });
  const contexts = new WeakMap();
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    if (!/^webgl/.test(kind)) return real.call(this, kind, ...rest);
    if (!contexts.has(this)) contexts.set(this, nothing(this));
    return contexts.get(this);
  };
  addEventListener('DOMContentLoaded', () => {
    const box = document.createElement('div');
    box.setAttribute('role', 'status');
    box.style.cssText = 'position:fixed;z-index:4;top:35%;left:calc(var(--rn-left, 0px) + 20px);'
      + 'right:calc(var(--rn-right, 0px) + 20px);max-width:34em;margin:0 auto;font:15px/1.5 system-ui,sans-serif';
    box.innerHTML = 'SENTENCE';
    document.body.append(box);
  });
})();
