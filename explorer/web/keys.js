// Runs in the visitor's browser (viser 1.1.1). Keys belong to what has the focus; a command finds a control and goes there.
//
// viser listens for the keys of commands at the root element and ignores text boxes only: an arrow on a slider would also
// step the time, and Space on a button would also play. This listener is further in, and keeps such keys from the root.
(() => {
  if (window.rnKeys) { window.rnKeys.hints = HINTS; return; }
  const ARROWS = ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End'];
  const OWNERS = [
    ['[role=slider], [role=tab], [role=listbox], [role=option], [role=menu]', ARROWS],
    ['button, summary, a, [role=button], [role=tab], [role=option]', [' ', 'Enter']],
  ];
  document.body.addEventListener('keydown', event => {
    const focus = event.target.closest ? event.target : document.body;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (OWNERS.some(([owner, keys]) => keys.includes(event.key) && focus.closest(owner))) event.stopPropagation();
  });

  // The palette writes keys as viser names them.
  const KEYS = {arrowleft: '←', arrowright: '→', arrowup: '↑', arrowdown: '↓', space: 'Space', home: 'Home', escape: 'Esc'};
  const rename = () => document.querySelectorAll('.mantine-Spotlight-action *').forEach(part => {
    if (part.children.length) return;
    const text = part.textContent, end = text.match(/^(.*\()?(arrow\w+|space|home|escape)(\))?$/);
    if (end && KEYS[end[2]]) part.firstChild.nodeValue = (end[1] || '') + KEYS[end[2]] + (end[3] || '');
  });
  document.addEventListener('keydown', () => [60, 200, 500].forEach(later => setTimeout(rename, later)), true);
  document.addEventListener('click', () => [200, 500].forEach(later => setTimeout(rename, later)), true);

  // A label has the hint of its control, and a control the name of its label.
  const name = label => label.textContent.replace(' •', '').trim();
  document.addEventListener('pointerover', event => {
    const label = event.target.closest && event.target.closest('label[for]');
    const hint = label && window.rnKeys.hints[name(label)];
    if (hint && label.title !== hint) label.title = hint;
  });
  const row = label => label.closest('p').parentElement.parentElement;
  document.addEventListener('focusin', event => {
    const focus = event.target, labels = [...document.querySelectorAll('label[for]')];
    if (!focus.matches || !focus.matches('[role=slider], input, textarea') || focus.getAttribute('aria-label')) return;
    const own = labels.find(label => label.closest('p') && row(label).contains(focus));
    if (own) focus.setAttribute('aria-label', name(own));
  });

  // A hint in the right dock would cover the control above: it is shown over the scene, level with its own control.
  const edge = () => innerWidth - parseFloat(document.documentElement.style.getPropertyValue('--rn-right') || 0);
  const aside = () => document.querySelectorAll('.mantine-Tooltip-tooltip').forEach(hint => {
    const box = hint.getBoundingClientRect();
    if (hint.style.transform || box.left < edge() || box.width > edge()) return;
    hint.style.transform = `translate(${edge() - box.right - 8}px, ${box.height / 2 + 16}px)`;
    hint.querySelectorAll('.mantine-Tooltip-arrow').forEach(arrow => { arrow.style.visibility = 'hidden'; });
  });
  document.addEventListener('pointerover', event => {
    if (event.clientX > edge()) [505, 525, 550, 600, 800].forEach(later => setTimeout(aside, later));
  });

  const pause = ms => new Promise(done => setTimeout(done, ms));
  const own = element => element.firstChild && element.firstChild.nodeType === 3 ? element.firstChild.data.trim() : '';
  const show = async ([kind, wanted]) => {
    if (kind === 'tab') {
      const tab = [...document.querySelectorAll('[role=tab]')].find(one => one.textContent.trim() === wanted);
      if (tab && tab.getAttribute('aria-selected') !== 'true') { window.rnPlaces.open(tab); await pause(200); }
    }
    if (kind === 'folder') {
      await pause(100);
      const head = [...document.querySelectorAll('.mantine-Paper-root')].find(one => own(one) === wanted);
      const body = head && head.nextElementSibling;
      if (body && body.getBoundingClientRect().height < 2) { head.click(); await pause(300); }
    }
  };
  const inside = heading => {
    const head = heading && [...document.querySelectorAll('.mantine-Paper-root')].find(one => own(one) === heading);
    return (head && head.nextElementSibling) || document;
  };
  const found = (wanted, heading) => {
    const labels = [...inside(heading).querySelectorAll('label[for]')].filter(one => one.getBoundingClientRect().height > 0);
    const label = labels.find(one => name(one) === wanted);
    const dock = document.querySelector('[data-dock-region="right"]') || document;
    const button = () => [...inside(heading).querySelectorAll('button'), ...dock.querySelectorAll('button')].find(
      one => one.textContent.trim() === wanted && !one.dataset.rnEvent && one.getBoundingClientRect().height > 0);
    return label ? row(label) : document.querySelector(`[data-plot="${wanted}"], [data-rn-place="${wanted}"]`) || button();
  };
  const intoSight = wanted => {  // a picture is drawn anew while it fills; one that is in sight stays where it is
    const place = document.querySelector(`[data-rn-place="${wanted}"]`), box = place && place.getBoundingClientRect();
    const seen = y => place.contains(document.elementFromPoint(box.left + box.width / 2, y));
    if (box && !(seen(box.top + 2) && seen(box.bottom - 2))) place.scrollIntoView({block: 'center'});
  };
  const go = async (steps, wanted) => {
    for (const step of steps) await show(step);
    if (!wanted) return;
    const [kind, heading] = steps.length ? steps[steps.length - 1] : ['', ''], around = kind === 'folder' ? heading : '';
    for (let tries = 0; tries < 30 && !found(wanted, around); tries++) await pause(100);
    const place = found(wanted, around) || found(wanted);
    if (!place) return;
    // a folder that is being opened still grows
    if (place.dataset.rnPlace) { [0, 350, 800].forEach(later => setTimeout(() => intoSight(wanted), later)); return; }
    [0, 350, 800].forEach(later => setTimeout(() => place.scrollIntoView({block: 'center'}), later));
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    place.animate([{background: '#56B4E966'}, {background: '#56B4E966', offset: still ? 1 : 0.6}, {background: still ? '#56B4E966' : '#56B4E900'}], 1800);
    const control = place.matches('button') ? place : !place.dataset.plot && place.querySelector('[role=slider], input, textarea, button');
    if (control) control.focus({preventScroll: true});
  };
  window.rnKeys = {hints: HINTS, go};
})();
