// A handout in the browser: one moment and one variant are shown; sliders and the play bar choose them.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  // A browser prints a drawing of WebGL only if its pixels are kept.
  const context = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return context.call(this, kind, kind.startsWith('webgl') ? {...options, preserveDrawingBuffer: true} : options);
  };
  const by = id => document.getElementById(id);
  const base = data.base;
  let shown = base, moment = 0, playing = false, last = 0, printing = false;
  const of = key => shown[key] || base[key];
  // On paper everything is dark on light, whatever the screen shows.
  const ink = () => printing ? '#000' : getComputedStyle(document.body).color;
  const line = () => printing ? '#ccc' : getComputedStyle(document.querySelector('footer')).borderTopColor;
  // The plots and the verdict answer the prediction of a lesson.
  const waits = () => !!document.querySelector('.choice') && !document.documentElement.classList.contains('predicted');
  const RUNS = {truth: '#0072B2', estimate: '#D55E00', anchor: '#6B7785'};

  // A rotation vector turns the axes of the body.
  const turned = (r, v) => {
    const angle = Math.hypot(...r);
    if (angle < 1e-12) return v;
    const u = r.map(c => c / angle), c = Math.cos(angle), s = Math.sin(angle);
    const dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    return v.map((x, k) => x * c + cross[k] * s + u[k] * dot * (1 - c));
  };
  const size = () => {
    const spread = base.truth.map(axis => Math.max(...axis) - Math.min(...axis));
    return Math.max(...spread, 1) / 6;
  };
  const at = (columns, k) => columns.map(column => column[k]);
  const body = (position, attitude, length) => {
    const points = {x: [], y: [], z: []};
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0]].forEach((axis, k) => {
      const tip = turned(attitude, axis.map(c => c * length * (k === 0 ? 1.4 : 1)));
      ['x', 'y', 'z'].forEach((name, j) => points[name].push(position[j], position[j] + tip[j], null));
    });
    return points;
  };
  const TAIL = 40;
  const scene = k => {
    const truth = of('truth'), estimate = shown.estimate, length = size();
    const from = Math.max(0, k - TAIL);
    const tail = estimate.map(column => column.slice(from, k + 1));
    const box = limits(truth);
    const inside = [0, 1, 2].every(j => estimate[j][k] >= box[j][0] && estimate[j][k] <= box[j][1]);
    const vehicle = body(at(truth, k), at(of('attitude'), k), length);
    const ghost = body(at(estimate, k), at(shown.estimated_attitude, k), length);
    const anchor = of('anchor');
    const mode = 'lines';
    return [
      {type: 'scatter3d', mode, name: 'true path', x: truth[0], y: truth[1], z: truth[2], line: {color: RUNS.truth, width: 3}, hoverinfo: 'skip'},
      {type: 'scatter3d', mode, name: 'estimate', x: tail[0], y: tail[1], z: tail[2], line: {color: RUNS.estimate, width: 4}, hoverinfo: 'skip'},
      {type: 'scatter3d', mode: 'markers', name: 'anchor', x: [anchor[0]], y: [anchor[1]], z: [anchor[2]], marker: {color: RUNS.anchor, size: 6, symbol: 'diamond'}, hoverinfo: 'skip'},
      {type: 'scatter3d', mode, showlegend: false, ...vehicle, line: {color: RUNS.truth, width: 8}, hoverinfo: 'skip'},
      {type: 'scatter3d', mode, showlegend: false, visible: inside, ...ghost, line: {color: RUNS.estimate, width: 6}, hoverinfo: 'skip'},
    ];
  };
  const limits = truth => {
    const anchor = of('anchor'), length = size() * 1.6;
    return [0, 1, 2].map(j => [Math.min(...truth[j], anchor[j]) - length, Math.max(...truth[j], anchor[j]) + length]);
  };
  const upright = () => {
    const g = of('gravity'), n = Math.hypot(...g) || 1;
    return {x: -g[0] / n, y: -g[1] / n, z: -g[2] / n};
  };
  const sceneLayout = () => {
    const range = limits(of('truth')), up = upright();
    const axis = (title, j) => ({title: {text: title}, range: range[j], nticks: 5, color: ink(), gridcolor: line(), showbackground: false});
    const eye = {x: 1.5, y: 1.5, z: up.z < 0 ? -0.9 : 0.9};
    return {
      margin: {l: 0, r: 0, t: 0, b: 0}, paper_bgcolor: 'transparent', font: {color: ink()}, uirevision: 'kept',
      legend: {orientation: 'h', x: 0, y: 1, bgcolor: 'transparent'},
      scene: {xaxis: axis('x (m)', 0), yaxis: axis('y (m)', 1), zaxis: axis('z (m)', 2), aspectmode: 'data', camera: {up, eye}},
    };
  };
  const DASHES = dash => dash.length ? dash.map(d => d + 'px').join(',') : 'solid';
  const traces = (plot, k) => Object.entries(shown.plots[k].y).map(([i, y]) => {
    const curve = plot.curves[i];
    return {
      x: shown.plots[k].t, y, mode: 'lines', name: curve.label, showlegend: curve.legend,
      line: {color: curve.color, width: curve.width, dash: DASHES(curve.dash)},
    };
  });
  const plotLayout = (plot, k) => {
    const [low, high] = shown.plots[k].axis;
    return {
      margin: {l: 58, r: 10, t: 8, b: 38}, paper_bgcolor: 'transparent', plot_bgcolor: 'transparent', font: {color: ink()},
      legend: {orientation: 'h', y: 1.14}, hovermode: 'x unified', hoverlabel: {bgcolor: getComputedStyle(document.body).backgroundColor},
      xaxis: {title: {text: plot.x + ' (s)'}, gridcolor: line(), zeroline: false},
      yaxis: {type: plot.log ? 'log' : 'linear', range: plot.log ? [Math.log10(low), Math.log10(high)] : [low, high],
        gridcolor: line(), zeroline: !plot.log, exponentformat: 'power'},
      shapes: plot.along ? [{type: 'line', x0: of('time')[moment], x1: of('time')[moment], y0: 0, y1: 1, yref: 'paper', line: {color: ink(), width: 1}}] : [],
      annotations: shown.plots[k].empty ? [{text: shown.plots[k].empty, showarrow: false, xref: 'paper', yref: 'paper', x: .5, y: .5}] : [],
    };
  };
  // What a plot shows, for whoever does not see it: where each curve lies, and where it ends.
  const short = value => String(Number(value.toPrecision(3)));
  const inWords = (plot, k) => {
    const curves = Object.entries(shown.plots[k].y).map(([i, y]) => {
      const name = plot.curves[i].label, known = y.filter(value => value !== null && Number.isFinite(value));
      if (!name) return '';
      if (!known.length) return name + ': no values.';
      return `${name}: from ${short(Math.min(...known))} to ${short(Math.max(...known))}, at the end ${short(known[known.length - 1])}.`;
    });
    return [`Plot: ${plot.title}${plot.unit ? ' (' + plot.unit + ')' : ''} over ${plot.x}.`, shown.plots[k].empty || '', ...curves]
      .filter(Boolean).join(' ');
  };
  const OPTIONS = {responsive: true, displaylogo: false, displayModeBar: false};

  const boxes = data.plots.map(plot => {
    const box = document.createElement('div'), drawn = document.createElement('div'), title = document.createElement('b');
    box.className = 'plot';
    title.textContent = plot.title + (plot.unit ? ' (' + plot.unit + ')' : '');
    const more = document.createElement('details');
    more.innerHTML = '<summary>what it shows</summary><p>' + plot.equation + '</p><p>' + plot.meaning + '</p>';
    box.append(title, drawn, more);
    by('plots').append(box);
    return drawn;
  });
  const drawMoment = () => {
    const time = of('time')[moment];
    Plotly.react('scene', scene(moment), sceneLayout(), OPTIONS);
    data.plots.forEach((plot, k) => {
      if (plot.along && !waits()) Plotly.relayout(boxes[k], {'shapes[0].x0': time, 'shapes[0].x1': time});
    });
    by('time').value = moment;
    by('now').textContent = time.toFixed(2) + ' s';
    const error = shown.error[moment];
    by('offset').textContent = error === null ? 'There is no estimate here.' : 'The estimate is ' + Number(error.toPrecision(3)) + ' m off.';
    const [place, anchor] = [at(of('truth'), moment), of('anchor')];
    const away = Math.hypot(...place.map((c, j) => c - anchor[j]));
    by('scene').setAttribute('aria-label', `The true path, the estimate and the anchor in three dimensions. At ${time.toFixed(2)} s the vehicle `
      + `is at (${place.map(short).join(', ')}) m, ${short(away)} m from the anchor.` + (waits() ? '' : ' ' + by('offset').textContent));
  };
  const drawAll = () => {
    if (!waits()) data.plots.forEach((plot, k) => {
      Plotly.react(boxes[k], traces(plot, k), plotLayout(plot, k), OPTIONS);
      boxes[k].setAttribute('role', 'img');
      boxes[k].setAttribute('aria-label', inWords(plot, k));
    });
    const verdict = shown.verdict, sign = document.createElement('b');
    sign.textContent = verdict.sign + ' ' + verdict.word;
    sign.style.color = verdict.color;
    by('verdict').replaceChildren(sign, ' ' + verdict.summary);
    by('answers').querySelector('table').replaceChildren(...verdict.answers.map(([mark, question, ...texts]) => {
      const row = document.createElement('tr');
      [mark + ' ' + question, texts.join(' ')].forEach(text => { const cell = document.createElement('td'); cell.textContent = text; row.append(cell); });
      return row;
    }));
    by('time').max = of('time').length - 1;
    moment = Math.min(moment, of('time').length - 1);
    drawMoment();
  };

  // One slider moves at a time: each was computed by itself, and the others go back to where the page was.
  const inputs = data.sliders.map(slider => {
    const label = document.createElement('label'), input = document.createElement('input'), value = document.createElement('output');
    Object.assign(input, {type: 'range', min: 0, max: slider.values.length - 1, step: 1, value: slider.at});
    input.setAttribute('aria-label', slider.label);
    value.textContent = slider.values[slider.at];
    label.append(slider.label, input, value);
    by('sliders').append(label);
    input.addEventListener('input', () => {
      inputs.forEach(([other, text, one]) => { if (other !== input) { other.value = one.at; text.textContent = one.values[one.at]; } });
      value.textContent = slider.values[input.value];
      shown = slider.variants[input.value];
      drawAll();
    });
    return [input, value, slider];
  });

  const step = now => {
    if (!playing) return;
    const time = of('time'), ahead = (now - last) / 1000;
    let next = moment;
    while (next < time.length - 1 && time[next] - time[moment] < ahead) next += 1;
    if (next > moment) { last = now; moment = next; drawMoment(); }
    if (moment >= time.length - 1) moment = 0;
    requestAnimationFrame(step);
  };
  const press = on => {
    playing = on;
    by('play').textContent = on ? '❚❚' : '▶';
    if (on) { last = performance.now(); requestAnimationFrame(step); }
  };
  by('play').addEventListener('click', () => press(!playing));
  by('time').addEventListener('input', () => { press(false); moment = Number(by('time').value); drawMoment(); });

  document.querySelectorAll('.choice').forEach(choice => choice.addEventListener('click', () => {
    if (document.documentElement.classList.contains('predicted')) return;
    const number = by('number');
    if (number && !number.value.trim()) return;
    choice.setAttribute('aria-pressed', 'true');
    by('predicted').textContent = number ? number.value.trim() : choice.textContent;
    document.documentElement.classList.add('predicted');
    drawAll();
  }));
  const paper = on => {
    printing = on;
    by('answers').open = on;
    drawAll();
    if (!waits()) boxes.forEach(box => Plotly.relayout(box, on ? {width: 320, height: 200} : {width: null, height: null, autosize: true}));
  };
  addEventListener('beforeprint', () => paper(true));
  addEventListener('afterprint', () => paper(false));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAll);
  drawAll();
})();
