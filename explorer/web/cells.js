// Runs in the visitor's browser (viser 1.1.1). A picture of cells: the mouse reads them, a click takes one; the arrow keys
// move a cursor, and Enter takes the cell at it.
//
//   <div data-rn-grid="map-take" data-rn-cells='{"axes":…,"x":…,"y":…,"texts":…,"notes":…,"noted":…,"start":[3,5]}'>
//     … <div class="rn-cells-cursor"></div>
//   </div>
//   <div class="rn-cells-read"></div>           behind it, somewhere in the same .rn-map
//
// A session writes the picture anew while it fills: the cursor is therefore kept here.
(() => {
  if (window.rnCells) return;
  window.rnCells = true;
  const read = new Map();  // the newest content of each grid, parsed
  let at = {};             // the cursor of each grid, by its name
  const content = grid => {
    const text = grid.dataset.rnCells, kept = read.get(grid.dataset.rnGrid);
    if (kept && kept.text === text) return kept.cells;
    const cells = JSON.parse(text);
    read.set(grid.dataset.rnGrid, {text, cells});
    return cells;
  };
  const sentence = (cells, [i, j]) => {
    const k = i * cells.y.length + j, note = cells.notes[cells.noted[k]];
    return `${cells.axes[0]} ${cells.x[i]}, ${cells.axes[1]} ${cells.y[j]}: ${cells.texts[k]}${note ? '; ' + note : ''}`;
  };
  const show = (grid, cell, spoken) => {
    const cells = content(grid), line = grid.closest('.rn-map').querySelector('.rn-cells-read');
    const cursor = grid.querySelector('.rn-cells-cursor'), n = cells.x.length, m = cells.y.length;
    cursor.style.display = cell ? 'block' : 'none';
    if (!cell) return;
    cursor.style.left = 100 * cell[0] / n + '%';
    cursor.style.bottom = 100 * cell[1] / m + '%';
    cursor.style.width = 100 / n + '%';
    cursor.style.height = 100 / m + '%';
    const text = sentence(cells, cell);
    if (spoken) line.dataset.rnSay = 'cell: ' + text; else delete line.dataset.rnSay;
    if (line.textContent !== text) line.textContent = text;
  };
  const within = (grid, cell) => {
    const cells = content(grid), inside = (k, count) => Math.min(Math.max(k, 0), count - 1);
    return [inside(cell[0], cells.x.length), inside(cell[1], cells.y.length)];
  };
  const cursor = grid => within(grid, at[grid.dataset.rnGrid] || content(grid).start);
  const over = event => event.target.closest && event.target.closest('[data-rn-grid]');
  const under = (grid, event) => {
    const box = grid.getBoundingClientRect(), cells = content(grid);
    return within(grid, [Math.floor((event.clientX - box.left) / box.width * cells.x.length),
      Math.floor((box.bottom - event.clientY) / box.height * cells.y.length)]);
  };
  const take = (grid, cell) => window.rnPage.act('event', `${grid.dataset.rnGrid}-${cell[0]}-${cell[1]}`);
  let hovered = null, pointer = null;
  window.addEventListener('pointermove', event => {
    const grid = over(event);
    pointer = event;
    if (!grid && hovered && hovered.isConnected) show(hovered, document.activeElement === hovered ? cursor(hovered) : null);
    hovered = grid;
    if (grid) show(grid, under(grid, event));
  });
  new MutationObserver(() => {  // a new picture under a mouse that rests
    if (!hovered || hovered.isConnected) return;
    const element = document.elementFromPoint(pointer.clientX, pointer.clientY);
    hovered = element && element.closest('[data-rn-grid]');
    if (hovered) show(hovered, under(hovered, pointer));
  }).observe(document.body, {childList: true, subtree: true});
  window.addEventListener('click', event => {
    const grid = over(event);
    if (!grid) return;
    const cell = under(grid, event);
    at[grid.dataset.rnGrid] = cell;
    take(grid, cell);
  });
  const STEPS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  window.addEventListener('keydown', event => {
    const grid = over(event);
    if (!grid || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = STEPS[event.key], [i, j] = cursor(grid);
    if (!step && event.key !== 'Enter') return;
    event.preventDefault();
    event.stopPropagation();
    if (!step) { take(grid, [i, j]); return; }
    const far = event.shiftKey ? 5 : 1;
    at[grid.dataset.rnGrid] = within(grid, [i + far * step[0], j + far * step[1]]);
    show(grid, cursor(grid), true);
  }, true);
  document.addEventListener('focusin', event => {
    if (event.target.matches('[data-rn-grid]') && event.target.matches(':focus-visible')) show(event.target, cursor(event.target));
  });
  document.addEventListener('focusout', event => {
    if (event.target.matches && event.target.matches('[data-rn-grid]')) show(event.target, null);
  });
})();
