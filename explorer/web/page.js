// Runs in the visitor's browser (viser 1.1.1). It keeps what only the browser knows, and reports it to the session.
//
//   width=1366&height=768&flags=dark+unfolded&switched=sphere&plots=snap&tabs=motion&query=preset%3Dhover
//   &answered=1&event=1712345678901:repair
//
// flags    choices that are kept in localStorage: they are classes of the page's root element, so that the style sheet
//          follows without a round trip
// switched layers of the scene that were switched, off or on
// plots    plots in sight, or "none": those of closed tabs and of a folded panel have no box on the page
// tabs     open tabs, by their labels
// link     the text of a link, with the number of its arrival: the same one may be opened twice
// hidden   the browser shows another tab
// answered what the address asks for was opened or refused
// event    buttons pressed in the last second, each with a number of its own: viser drops all but the last input of 50 ms
//
// A button of the page's own HTML names what it does:
//   data-rn-event="repair"      an action of the session
//   data-rn-flag="unfolded"     switches a flag
//   data-rn-layer="tail"        switches a layer of the scene
//   data-rn-tab="Gains"         brings a tab to the front
(() => {
  if (window.rnPage) { window.rnPage.report(true); return; }
  const KEY = 'rangenav-view', root = document.documentElement;
  const put = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set;
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const query = location.search.slice(1);
  // viser takes the fragment away from the address; where the visitor came from still has it. A reload goes on with the
  // visitor's own work.
  const shared = address => (address.match(/#(?:.*&)?s=([\w-]+)/) || ['', ''])[1];
  const came = performance.getEntriesByType('navigation')[0];
  let link = came && came.type !== 'reload' ? shared(location.href) || shared(came.name) : '';
  let arrivals = link ? 1 : 0;
  // What the address asks for is answered once: neither a reload nor a new connection asks again, but a new visit does.
  const ANSWERED = 'rangenav-answered';
  let answered = false;
  try {
    if (came && came.type === 'navigate') sessionStorage.removeItem(ANSWERED);
    answered = sessionStorage.getItem(ANSWERED) !== null;
  } catch (refused) { console.info(String(refused)); }
  const markAnswered = () => {
    answered = true;
    link = '';
    try { sessionStorage.setItem(ANSWERED, '1'); } catch (refused) { console.info(String(refused)); }
    report();
  };
  const asked = new URLSearchParams(query), present = asked.has('present');
  // whoever asks for something is not held up by the card
  let welcomed = SKIP_WELCOME || asked.has('preset') || asked.has('lesson') || link !== '';
  let kept = {flags: [], switched: []}, events = [], last = '', stamp = 0, plots = 'none', tabs = 'none';
  try { kept = {...kept, ...JSON.parse(localStorage.getItem(KEY))}; } catch (refused) { console.info(String(refused)); }
  const keep = () => {
    try { localStorage.setItem(KEY, JSON.stringify(kept)); } catch (refused) { console.info(String(refused)); }
  };
  const toggled = (list, name) => list.includes(name) ? list.filter(one => one !== name) : [...list, name];
  // 'theme' and 'type' say that the visitor has chosen the other one than the system's, or than the address asks for
  const flags = () => {
    const shown = kept.flags.filter(flag => flag !== 'theme' && flag !== 'type');
    if (welcomed && !shown.includes('welcomed')) shown.push('welcomed');
    if (dark.matches !== kept.flags.includes('theme')) shown.push('dark');
    if (present !== kept.flags.includes('type')) shown.push('big');
    return shown;
  };
  const press = (button, on) => {
    if (button.getAttribute('aria-pressed') !== String(on)) button.setAttribute('aria-pressed', on);
  };
  const mark = () => {
    const shown = flags();
    document.querySelectorAll('[data-rn-flag]').forEach(button =>
      press(button, kept.flags.includes(button.dataset.rnFlag) || shown.includes(button.dataset.rnFlag)));
    document.querySelectorAll('[data-rn-layer]').forEach(button =>
      press(button, kept.switched.includes(button.dataset.rnLayer) === ('rnOff' in button.dataset)));
  };
  const show = () => {
    const shown = flags();
    [...root.classList].filter(name => name.startsWith('rn-is-')).forEach(name => root.classList.remove(name));
    shown.forEach(flag => root.classList.add('rn-is-' + flag));
    mark();
  };
  const report = again => {
    const mark = document.querySelector('.rn-door');
    const box = mark && mark.parentElement.nextElementSibling && mark.parentElement.nextElementSibling.querySelector('input');
    if (!box) { setTimeout(() => report(again), 50); return; }
    events = events.filter(event => Date.now() - parseInt(event) < 1000);
    const text = new URLSearchParams([
      ['width', innerWidth], ['height', innerHeight], ['flags', flags().join(' ')], ['switched', kept.switched.join(' ')],
      ['plots', plots], ['tabs', tabs],
      ...(document.hidden ? [['hidden', '1']] : []),
      ['query', query], ...(link ? [['link', link], ['arrival', arrivals]] : []), ...(answered ? [['answered', '1']] : []), ...events.map(event => ['event', event]),
    ]).toString();
    if (text === last && !again) return;
    last = text;
    put.call(box, text);
    box.dispatchEvent(new Event('input', {bubbles: true}));
  };
  // viser's docks take a press for the beginning of a drag; the Enter key only selects
  const select = label => {
    const tab = [...document.querySelectorAll('[role=tab]')].find(one => one.textContent.trim() === label);
    if (!tab) return;
    if (tab.dataset.dockTab === undefined) tab.click();
    else tab.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', code: 'Enter', bubbles: true, cancelable: true}));
  };
  const change = () => { keep(); show(); report(); };
  const act = (kind, name) => {
    if (kind === 'flag') {
      name.split(' ').forEach(flag => {
        const on = flags().includes(flag);
        if (flag === 'welcomed' && on) { welcomed = false; kept.flags = kept.flags.filter(one => one !== flag); }
        else kept.flags = toggled(kept.flags, flag);
      });
      change();
    }
    if (kind === 'tab') select(name);
    if (kind === 'layer') { kept.switched = toggled(kept.switched, name); change(); }
    if (kind === 'event') { stamp = Math.max(Date.now(), stamp + 1); events.push(stamp + ':' + name); report(); }
  };
  document.addEventListener('click', click => {
    const button = click.target.closest
      && click.target.closest('[data-rn-event], [data-rn-flag], [data-rn-layer], [data-rn-tab]');
    if (!button) return;
    if (button.dataset.rnEvent) act('event', button.dataset.rnEvent);
    if (button.dataset.rnFlag) act('flag', button.dataset.rnFlag);
    if (button.dataset.rnLayer) act('layer', button.dataset.rnLayer);
    if (button.dataset.rnTab) act('tab', button.dataset.rnTab);
  });
  addEventListener('hashchange', () => {
    const next = shared(location.href);
    if (!next) return;
    link = next;
    arrivals += 1;
    history.replaceState(history.state, '', location.pathname + location.search);  // so that the same link can be opened again
    report();
  });
  const copyLink = fragment => {
    const address = location.origin + location.pathname + '?' + fragment;  // viser makes its socket's address of all before the ?
    const aside = () => {
      const box = document.createElement('textarea');
      box.value = address; document.body.append(box); box.select(); document.execCommand('copy'); box.remove();
    };
    if (navigator.clipboard && navigator.clipboard.writeText) navigator.clipboard.writeText(address).catch(aside); else aside();
  };
  dark.addEventListener('change', () => { show(); report(); });
  document.addEventListener('visibilitychange', () => report());  // a hidden page is sent no frames
  let later = 0;
  addEventListener('resize', () => { clearTimeout(later); later = setTimeout(report, 200); });

  // viser reports neither which tabs are open nor which panel is folded
  const look = () => {
    const boxes = [...document.querySelectorAll('[data-plot]')].filter(plot => plot.getClientRects().length);
    const seen = boxes.map(plot => plot.dataset.plot).join(' ') || 'none';
    const chosen = [...document.querySelectorAll('[role=tab][aria-selected=true]')];
    const open = chosen.map(tab => tab.textContent.trim().toLowerCase().replaceAll(' ', '-')).join(' ') || 'none';
    if (seen !== plots || open !== tabs) { plots = seen; tabs = open; report(); }
  };
  setInterval(look, 100);

  // Whoever was sent out, or was in a class that is over, would wait for a connection for ever: the door asks for the code.
  const WAIT = 1500, PATIENT = 10000;
  let alone = 0;
  setInterval(() => {
    if (document.querySelector('.tabler-icon-cloud-check')) { alone = 0; return; }  // viser's sign of a connection
    alone += 1;
    if (alone !== 1 && (alone * WAIT) % PATIENT >= WAIT) return;
    fetch(location.pathname, {cache: 'no-store'}).then(answer => { if (answer.status === 401) location.reload(); }, () => {});
  }, WAIT);

  // What the docks leave to the scene: the verdict lies above it, and the timeline below it.
  const fit = () => {
    const scene = document.querySelector('[data-dock-root] > :first-child');
    if (!scene) { requestAnimationFrame(fit); return; }
    new ResizeObserver(() => {
      const box = scene.getBoundingClientRect();
      root.style.setProperty('--rn-left', box.left + 'px');
      root.style.setProperty('--rn-right', (innerWidth - box.right) + 'px');
    }).observe(scene);
  };
  const style = document.createElement('style');
  style.textContent = STYLE_SHEET;
  document.head.append(style);
  let marking = 0;
  new MutationObserver(() => {
    marking = marking || setTimeout(() => { marking = 0; mark(); }, 200);
  }).observe(document.body, {childList: true, subtree: true});
  window.rnPage = {report, act, copyLink, markAnswered};
  show(); fit(); report();
})();
