// Runs in the visitor's browser (viser 1.1.1). It remembers the open tabs and folders of this browser tab over a reload,
// and opens the preset anew that is chosen in the menu although it is open already: viser reports no such choice.
//
// viser tells nobody which tab or folder is open, and mounts what is in a tab only while the tab is open. So what is
// remembered is applied to each tab list and each heading when it appears; a tab list only until its visitor has chosen.
(() => {
  if (window.rnPlaces) return;
  const KEY = 'rangenav-places', MENU = 'preset', MOST_TRIES = 8;
  let kept = {tabs: [], folders: {}};
  try { kept = {...kept, ...JSON.parse(sessionStorage.getItem(KEY))}; } catch (refused) { console.info(String(refused)); }
  if (FIRST && !kept.tabs.length) kept.tabs = [FIRST];
  const keep = () => {
    try { sessionStorage.setItem(KEY, JSON.stringify(kept)); } catch (refused) { console.info(String(refused)); }
  };
  const waiting = new Map(Object.entries(kept.folders)), done = new WeakSet(), tries = new WeakMap(), noted = new Map();
  const text = element => element.textContent.trim();
  const label = head => head.firstChild && head.firstChild.nodeType === 3 ? head.firstChild.data.trim() : '';
  const heads = () => [...document.querySelectorAll('.mantine-Paper-root > .mantine-Paper-root:first-child')];
  const isOpen = head => head.nextElementSibling.getBoundingClientRect().height >= 2;

  const isSelected = tab => tab.getAttribute('aria-selected') === 'true';
  // A tab of a dock opens by a key or the mouse held down, and no script can drag; one of a phone's sheet by a click.
  const open = tab => {
    tab.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true, cancelable: true}));
    if (!isSelected(tab)) tab.click();
  };

  const apply = () => {
    for (const list of document.querySelectorAll('[role=tablist]')) {
      const wanted = [...list.querySelectorAll('[role=tab]')].find(tab => kept.tabs.includes(text(tab)));
      if (done.has(list) || !wanted) continue;
      const tried = tries.get(list) || 0;
      tries.set(list, tried + 1);
      if (isSelected(wanted) || tried >= MOST_TRIES) { done.add(list); continue; }
      open(wanted);
      setTimeout(apply, 500);  // a busy browser may not have taken it
    }
    for (const head of waiting.size ? heads() : []) {
      if (!waiting.has(label(head)) || !head.nextElementSibling) continue;
      if (isOpen(head) !== waiting.get(label(head))) head.click();
      waiting.delete(label(head));
    }
  };
  const remember = head => {
    if (!head.nextElementSibling) return;
    kept.folders[label(head)] = isOpen(head);
    waiting.delete(label(head));
    keep();
  };
  const chosen = at => {
    const list = at.closest('[role=tab]') && at.closest('[role=tablist]');
    if (!list) return;
    done.add(list);
    const note = () => {
      const tabs = [...list.querySelectorAll('[role=tab]')], others = tabs.map(text);
      kept.tabs = [...kept.tabs.filter(name => !others.includes(name)), ...tabs.filter(isSelected).map(text)];
      keep();
    };
    noted.set(list, note);
    [50, 300, 1000, 3000].forEach(later => setTimeout(note, later));  // a busy browser selects the tab later
  };
  document.addEventListener('keyup', key => key.target.closest && chosen(key.target), true);
  document.addEventListener('click', click => {
    const at = click.target.closest ? click.target : document.body;
    chosen(at);
    const head = at.closest('.mantine-Paper-root');
    if (head && label(head)) setTimeout(() => remember(head), 400);
    const option = at.closest('[role=option][aria-selected=true]'), options = option && option.closest('[role=listbox]');
    const box = options && document.querySelector(`input[aria-controls="${options.id}"]`);
    const name = box && document.querySelector(`label[for="${box.id}"]`);
    if (name && text(name).replace(' •', '') === MENU) window.rnPage.act('event', 'again');
  }, true);
  addEventListener('pagehide', () => noted.forEach((note, list) => { if (list.isConnected) note(); }));
  let soon = 0;
  new MutationObserver(() => {
    soon = soon || setTimeout(() => { soon = 0; apply(); }, 100);
  }).observe(document.body, {childList: true, subtree: true});
  window.rnPlaces = {apply, open};
  apply();
})();
