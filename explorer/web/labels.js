// viser (1.1.1) writes the labels of the 3-D picture black on white, whatever the page's colours are: on a dark page they
// would be the brightest things in sight. Here their two shaders get a number that says whether the page is dark. It runs
// before viser's own scripts, which compile a shader at once. A viser with other shaders keeps its own colours.
(() => {
  if (window.rnLabels !== undefined || !window.WebGL2RenderingContext) return;
  window.rnLabels = 0;  // shaders that have the number
  const context = WebGL2RenderingContext.prototype, {shaderSource, useProgram} = context, places = new WeakMap();
  const INK = 'gl_FragColor = vec4(0.0, 0.0, 0.0, a);', PAPER = 'gl_FragColor = vec4(1.0, 1.0, 1.0, 0.85 * vAlpha);';
  const ours = {
    [INK]: 'gl_FragColor = vec4(vec3(0.93 * rnDark), a);',
    [PAPER]: 'gl_FragColor = vec4(vec3(1.0 - 0.83 * rnDark), 0.85 * vAlpha);',
  };
  context.shaderSource = function (shader, source) {
    const theirs = [INK, PAPER].find(line => source.includes(line));
    if (theirs) window.rnLabels += 1;
    const mine = theirs
      ? source.replace(theirs, ours[theirs]).replace('void main()', 'uniform float rnDark;\nvoid main()') : source;
    return shaderSource.call(this, shader, mine);
  };
  context.useProgram = function (program) {
    useProgram.call(this, program);
    if (!program) return;
    if (!places.has(program)) places.set(program, this.getUniformLocation(program, 'rnDark'));
    const place = places.get(program);
    if (place) this.uniform1f(place, document.documentElement.classList.contains('rn-is-dark') ? 1 : 0);
  };
})();
