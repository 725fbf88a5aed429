// Runs in the visitor's browser (viser 1.1.1). It gives viser's markup what a keyboard and a reader of the screen need,
// and keeps the focus where the page's own HTML is replaced.
//
// folders  a heading is a button: Tab reaches it, Enter and Space open it
// names    a control has the name and the hint of its label; a slider over powers of ten says the number of its box
// hints    what the mouse shows as a tip, Tab shows, too
// focus    a button that is replaced after its press keeps the focus, if it was reached by the keyboard
// speech   data-rn-say="kind: text" is spoken when the text of its kind changes, and never while it is hidden
(() => {
  if (window.rnAccessibility) { window.rnAccessibility.hints = HINTS; return; }
  const set = (element, name, value) => {
    if (element.getAttribute(name) !== value) element.setAttribute(name, value);
  };
  const put = (element, values) => Object.entries(values).forEach(([name, value]) => set(element, name, value));
  let byKeyboard = false;
  document.addEventListener('keydown', () => { byKeyboard = true; }, true);
  document.addEventListener('pointerdown', () => { byKeyboard = false; }, true);

  const HEAD = '.mantine-Paper-root > .mantine-Paper-root:first-child';
  const isOpen = head => head.querySelector('.tabler-icon-chevron-up') !== null;  // its height would follow later
  const folders = () => document.querySelectorAll(HEAD).forEach(head => {
    if (head.style.cursor !== 'pointer') { head.removeAttribute('tabindex'); head.removeAttribute('role'); return; }
    put(head, {role: 'button', tabindex: '0', 'aria-expanded': String(isOpen(head))});
  });
  document.addEventListener('keydown', key => {
    const head = key.target.closest && key.target.matches(HEAD + '[role=button]') && key.target;
    if (!head || !['Enter', ' '].includes(key.key)) return;
    key.preventDefault();
    key.stopPropagation();
    head.click();
  }, true);
  document.addEventListener('click', click => {
    if (click.target.closest && click.target.closest(HEAD)) [100, 500].forEach(later => setTimeout(folders, later));
  }, true);

  const name = label => label.textContent.replace(' •', '').trim();
  const row = label => label.closest('p').parentElement.parentElement;
  const names = () => document.querySelectorAll('label[for]').forEach(label => {
    if (!label.closest('p')) return;
    const called = name(label), hint = window.rnAccessibility.hints[called] || window.rnAccessibility.hints[called.split(': ')[0]];
    row(label).querySelectorAll('[role=slider], input:not([type=hidden]), textarea').forEach(control => {
      if (control.id !== label.htmlFor) set(control, 'aria-label', called);
      if (hint) set(control, 'aria-description', hint);
    });
    const buttons = [...row(label).querySelectorAll('button')];
    if (buttons.length && called) put(buttons[0].parentElement, {role: 'group', 'aria-label': called});
  });
  const number = slider => {
    const label = [...document.querySelectorAll('label[for]')].find(
      one => name(one) === slider.getAttribute('aria-label') + ': number');
    const box = label && row(label).querySelector('input');
    if (box) set(slider, 'aria-valuetext', box.value);
  };
  ['focusin', 'keyup'].forEach(kind => document.addEventListener(kind, event => {
    const slider = event.target.matches && event.target.matches('[role=slider]') && event.target;
    if (slider) [0, 150, 400].forEach(later => setTimeout(number, later, slider));
  }, true));

  const ICONS = {'list-search': 'Find everything (Ctrl+K)', adjustments: 'Settings of the viewer', 'arrow-back': 'Back', 'arrows-maximize': 'Enlarge', maximize: 'Enlarge'};
  const parts = () => {
    if (document.title !== 'rangenav') document.title = 'rangenav';
    const part = (selector, role, called) => document.querySelectorAll(selector).forEach(
      element => put(element, {role, 'aria-label': called}));
    part('[data-dock-root] > :first-child', 'main', '3-D picture');
    part('[data-dock-region=left]', 'region', 'Plots');
    part('[data-dock-region=right]', 'region', 'Controls');
    document.querySelectorAll('[data-dock-root] > :first-child canvas').forEach(canvas => set(canvas, 'aria-hidden', 'true'));
    document.querySelectorAll('.mantine-Notification-closeButton').forEach(button => set(button, 'aria-label', 'Close'));
    document.querySelectorAll('.mantine-Spotlight-content[role=dialog]').forEach(box => set(box, 'aria-label', 'Find everything'));
    document.querySelectorAll('.mantine-ActionIcon-root:not([aria-label])').forEach(button => {
      const icon = [...button.querySelectorAll('svg')].map(one => (one.classList.value.match(/tabler-icon-([\w-]+)/) || [])[1])[0];
      set(button, 'aria-label', ICONS[icon] || icon || 'button');
    });
    document.querySelectorAll('.rn-door, .rn-pointer').forEach(mark => {
      const box = mark.parentElement.nextElementSibling;
      if (box) set(box, 'aria-hidden', 'true');
    });
  };

  document.addEventListener('keydown', key => {
    const root = document.documentElement.classList;
    if (key.key !== 'Escape' || !window.rnPage) return;
    const card = ['invite', 'predictions'].find(flag => root.contains('rn-is-' + flag));
    if (card) window.rnPage.act('flag', card);
    else if (!root.contains('rn-is-welcomed')) window.rnPage.act('flag', 'welcomed');
  }, true);

  // the hint of what has the focus, over the scene, level with it
  const tip = document.createElement('div');
  tip.className = 'rn-tip';
  tip.setAttribute('aria-hidden', 'true');
  let soon = 0;
  const hide = () => { clearTimeout(soon); tip.style.display = 'none'; };
  const show = element => {
    const text = element.getAttribute('aria-description') || element.title
      || window.rnAccessibility.hints[element.textContent.trim()];
    const box = element.getBoundingClientRect();
    if (!text || !element.isConnected || document.activeElement !== element) return;
    tip.textContent = text;
    tip.style.display = 'block';
    const right = innerWidth - parseFloat(document.documentElement.style.getPropertyValue('--rn-right') || 0);
    const aside = box.left >= right - 1 && right > 300;
    const left = aside ? right - tip.offsetWidth - 8 : Math.min(Math.max(box.left, 8), innerWidth - tip.offsetWidth - 8);
    const below = box.bottom + 6 + tip.offsetHeight < innerHeight ? box.bottom + 6 : box.top - tip.offsetHeight - 6;
    tip.style.left = left + 'px';
    tip.style.top = (aside ? Math.min(Math.max(box.top, 8), innerHeight - tip.offsetHeight - 8) : below) + 'px';
  };
  document.addEventListener('focusin', event => {
    hide();
    if (byKeyboard && event.target !== document.body) soon = setTimeout(show, 700, event.target);
  });
  document.addEventListener('focusout', hide);
  document.addEventListener('pointerdown', hide, true);
  document.addEventListener('keydown', key => { if (key.key !== 'Tab' && key.key !== 'Shift') hide(); }, true);

  // viser writes new HTML in place of the old: what had the focus is then another element with the same task
  const TASKS = ['data-rn-event', 'data-rn-flag', 'data-rn-layer', 'data-rn-tab', 'data-curve', 'data-rn-grid'];
  let held = null;
  document.addEventListener('focusin', event => {
    const element = event.target, around = [];
    for (let one = element.parentElement; one; one = one.parentElement) around.push(one);
    const task = TASKS.find(attribute => element.hasAttribute(attribute));
    held = {element, around, same: task && `[${task}="${element.getAttribute(task)}"]`, summary: element.matches('summary')};
  });
  document.addEventListener('focusout', event => {
    const element = event.target;
    setTimeout(() => { if (held && held.element === element && element.isConnected && document.activeElement !== element) held = null; });
  });
  const keepFocus = () => {
    if (!held || held.element.isConnected || document.activeElement !== document.body || !byKeyboard) return;
    const around = held.around.find(one => one.isConnected && one !== document.body && one !== document.documentElement);
    if (!around || !(held.same || held.summary)) { held = null; return; }
    const heading = around.querySelector('h2');
    const next = (held.same && around.querySelector(held.same + ':not([disabled])'))
      || heading || [...around.querySelectorAll('button:not([disabled]), summary')].find(one => one.checkVisibility());
    held = null;
    if (!next) return;
    if (next === heading) set(heading, 'tabindex', '-1');
    next.focus({preventScroll: true});
  };

  const spoken = document.createElement('div'), said = new Map();
  spoken.className = 'rn-unseen';
  spoken.setAttribute('aria-live', 'polite');
  let speaking = 0;
  const speak = () => {
    const fresh = [];
    document.querySelectorAll('[data-rn-say]').forEach(element => {
      const [kind, ...texts] = element.dataset.rnSay.split(': '), text = texts.join(': ');
      if (!element.checkVisibility({visibilityProperty: true}) || said.get(kind) === text) return;
      said.set(kind, text);
      if (text) fresh.push(text);
    });
    if (!fresh.length) return;
    spoken.textContent = '';
    clearTimeout(speaking);
    speaking = setTimeout(() => {
      spoken.textContent = fresh.join(' ');
      speaking = setTimeout(() => { spoken.textContent = ''; }, 5000);  // so that nobody comes upon it later
    }, 100);
  };

  const title = document.createElement('header');
  title.className = 'rn-unseen';
  title.innerHTML = '<h1>rangenav</h1>';
  document.body.prepend(title);
  document.body.append(tip, spoken);
  window.rnAccessibility = {hints: HINTS};
  const look = () => { parts(); folders(); names(); speak(); };
  let looking = 0;
  new MutationObserver(() => {
    keepFocus();
    looking = looking || setTimeout(() => { looking = 0; look(); }, 200);
  }).observe(document.body, {childList: true, subtree: true});
  look();
})();
