// Runs in the visitor's browser (viser 1.1.1). A menu that is searched by typing: viser keeps the old text in its box, takes
// nothing by Enter unless an arrow key has chosen, and shows an empty list without a word.
//
//   focus      the text is selected, so that typing replaces it
//   typing     a text that no option contains is said below the box
//   Enter      takes the only option that is left; of several it says how to choose
(() => {
  if (window.rnMenus) return;
  window.rnMenus = true;
  const menu = event => event.target.matches && event.target.matches('[data-dock-root] input[role=combobox]') ? event.target : null;
  const isOpen = box => box.getAttribute('aria-expanded') === 'true';
  const options = box => {
    const list = document.getElementById(box.getAttribute('aria-controls'));
    return list ? [...list.querySelectorAll('[role=option]')] : [];
  };
  const forget = () => document.querySelectorAll('.rn-menu-none').forEach(note => note.remove());
  const say = (around, text) => {
    forget();
    if (!around) return;
    const note = document.createElement('div');
    note.className = 'rn-menu-none';
    note.setAttribute('role', 'status');
    note.textContent = text;
    if (around.matches('[role=listbox]')) around.prepend(note); else around.append(note);
  };
  let fresh = null;
  document.addEventListener('focusin', event => { fresh = menu(event); });
  document.addEventListener('click', event => {
    const box = menu(event);
    if (box && box === fresh) box.select();
    fresh = null;
  });
  document.addEventListener('input', event => {
    const box = menu(event);
    if (box) setTimeout(() => {
      if (isOpen(box) && box.value.trim() && !options(box).length) say(box.closest('.mantine-InputWrapper-root'), `⚠ Nothing here is called “${box.value.trim()}”.`);
      else forget();
    }, 120);
  });
  document.addEventListener('focusout', forget);
  window.addEventListener('keydown', event => {
    const box = menu(event);
    if (!box || event.key !== 'Enter' || !isOpen(box)) return;
    const left = options(box);
    if (left.some(one => one.hasAttribute('data-combobox-selected'))) return;
    if (left.length === 1) left[0].click();
    else if (left.length > 1) say(left[0].closest('[role=listbox]'), `⚠ ${left.length} names fit: choose one with ↓ and Enter.`);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }, true);
})();
