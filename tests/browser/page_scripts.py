"""What a page of a test is told before its own scripts run: to draw seldom, coarsely, or nothing at all."""

WELCOMED = "localStorage['rangenav-view'] ??= JSON.stringify({flags: ['welcomed'], switched: []})"
"""The card of the first visit was closed before: most tests are not about it."""
FRAME_PAUSE = 100
"""ms between two frames of the page."""
FEW_FRAMES = f"""(() => {{
    const next = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = draw => setTimeout(next, {FRAME_PAUSE}, draw);
    window.cancelAnimationFrame = clearTimeout;
}})()"""
"""A software renderer would draw the scene over and over as fast as it can, and take the processor from the server."""
ONE_SAMPLE = """(() => {
    const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, options) {
        return get.call(this, kind, {...options, antialias: false});
    };
})()"""
"""A page with coarse pixels takes one sample of each and not four."""
UNDRAWN = """(() => {
    const names = window.WebGL2RenderingContext, get = HTMLCanvasElement.prototype.getContext, made = new WeakMap();
    if (!names) return;
    const none = [names.ACTIVE_UNIFORMS, names.ACTIVE_ATTRIBUTES, names.ACTIVE_UNIFORM_BLOCKS];
    const answers = {
        getParameter: name => [names.VERSION, names.SHADING_LANGUAGE_VERSION].includes(name) ? 'WebGL 2.0'
            : [names.VIEWPORT, names.SCISSOR_BOX].includes(name) ? new Int32Array(4) : 4096,
        getContextAttributes: () => ({alpha: true, depth: true, stencil: false, antialias: false}),
        getShaderPrecisionFormat: () => ({precision: 23, rangeMin: 127, rangeMax: 127}),
        getProgramParameter: (_, name) => none.includes(name) ? 0 : true,
        getShaderParameter: () => true,
        getSupportedExtensions: () => [],
        getExtension: name => name.includes('color_buffer') ? {} : null,
        getUniformLocation: () => null,
        getAttribLocation: () => -1,
        getUniformBlockIndex: () => names.INVALID_INDEX,
        checkFramebufferStatus: () => names.FRAMEBUFFER_COMPLETE,
        clientWaitSync: () => names.ALREADY_SIGNALED,
        getError: () => names.NO_ERROR,
        isContextLost: () => false,
        getProgramInfoLog: () => '',
        getShaderInfoLog: () => '',
    };
    const idle = canvas => new Proxy({canvas, ...answers}, {get: (known, name) => {
        if (name in known || typeof name !== 'string') return known[name];
        if (name === 'drawingBufferWidth') return canvas.width;
        if (name === 'drawingBufferHeight') return canvas.height;
        if (name in names) return names[name];
        return name.startsWith('create') ? () => ({}) : () => undefined;
    }});
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        if (!kind.startsWith('webgl')) return get.call(this, kind, ...rest);
        if (!made.has(this)) made.set(this, idle(this));
        return made.get(this);
    };
})()"""
"""A scene that no test looks at is computed and not drawn: every canvas of three.js gets a context that does nothing. A
software renderer would take a sixth of a page's beginning for its shaders, and a third of all time to draw."""
