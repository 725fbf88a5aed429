// Runs in the visitor's browser (viser 1.1.1). Every input arrives once it is complete, whatever comes after it.
//
// viser sends an input at once and then none for 50 ms; of those that come meanwhile it sends the last one alone. On a
// page that is busy its timer comes late, and a number that was typed would be lost by the press of the next button.
// Here the timer of an input ends as soon as the visitor, or a script of this page, begins the next one: what waits is
// sent before it. A slider that is dragged begins nothing new, so viser still sends one of its positions every 50 ms.
//
// viser sends every letter that is typed: of 1e99 it would send 1 at first, and the page would show that. A text goes
// off when the typing pauses, by Enter, or when the box is left. What a script writes goes off at once.
(() => {
  if (window.rnInputs) { window.rnInputs(); return; }
  const PERIOD = 50, PAUSE = 400, start = window.setTimeout, waiting = new Map();
  let send = null, sent = false, typing = null, typed = false, text = null, pause = 0;
  window.setTimeout = (end, period, ...given) => {
    if (!sent || period !== PERIOD) return start(end, period, ...given);
    sent = false;
    const timer = start(() => { waiting.delete(timer); end(); }, period);
    waiting.set(timer, end);
    return timer;
  };
  const sendInput = message => {
    if (typed && message.type === 'GuiUpdateMessage') text = message; else send(message);
    sent = message.type.startsWith('Gui');  // viser starts its timer next
    queueMicrotask(() => { sent = false; });
  };
  const sendWaiting = () => [...waiting].forEach(([timer, end]) => { waiting.delete(timer); clearTimeout(timer); end(); });
  const sendText = () => {
    clearTimeout(pause);
    const complete = text;
    typing = text = null;
    if (complete && send) send(complete);
  };

  const isText = box => box.matches('input, textarea') && box.closest('[data-dock-root]')
    && !box.matches('[aria-haspopup], [type=range], [type=checkbox]');
  const begin = event => {
    typed = false;
    sendWaiting();
    if (event.isTrusted && event.target !== typing) sendText();
  };
  ['input', 'pointerdown', 'click', 'keydown'].forEach(kind => window.addEventListener(kind, begin, true));
  window.addEventListener('input', event => {
    if (!event.isTrusted || !isText(event.target)) return;
    typing = event.target;
    typed = true;  // until viser has taken the event
    clearTimeout(pause);
    pause = start(sendText, PAUSE);
  }, true);
  window.addEventListener('input', () => { typed = false; });
  window.addEventListener('focusout', sendText, true);
  window.addEventListener('keydown', event => { if (event.key === 'Enter') sendText(); }, true);

  // viser makes its sender anew with each connection.
  const watch = window.rnInputs = () => {
    const viewer = window.__viserMutable;
    if (!viewer || viewer.rnWatched) return;
    send = viewer.sendMessage;
    Object.defineProperty(viewer, 'sendMessage', {get: () => send && sendInput, set: next => { send = next; }});
    viewer.rnWatched = true;
  };
  watch();
})();
