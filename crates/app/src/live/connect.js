// Joins the page to its server: messages, the verdict, and what the reader is told.

const SIGNS = { yes: '✓', no: '✗', partly: '~', open: '?' };

// Says something in view, with buttons for what can be done about it, until it is dismissed or the time is over (ms).
function told(text, { acts = [], lasts = 0 } = {}) {
  const box = document.querySelector('.told');
  clearTimeout(told.timer);
  box.replaceChildren();
  if (!text) return;
  const close = () => told('');
  box.append(element('span', {}, text), ...acts.map(([name, act]) => button(name, '', () => { close(); act(); })), button('×', 'Dismisses this message', close));
  if (lasts) told.timer = setTimeout(close, lasts);
}

// A word of the page whose meaning is shown where it is pressed.
function term(word, text = word) {
  const meaning = TERMS[word];
  if (!meaning) return text;
  const box = document.querySelector('#meaning');
  const made = button(text, meaning, () => {
    box.replaceChildren(element('b', {}, word), `: ${meaning}`);
    box.showPopover();
    const { left, bottom } = made.getBoundingClientRect();
    box.style.inset = `${Math.min(bottom + 6, innerHeight - box.offsetHeight - 8)}px auto auto ${Math.max(Math.min(left, innerWidth - box.offsetWidth - 12), 8)}px`;
  }, 'term');
  return made;
}

function number(value) {
  return value === null || value === undefined ? '–' : Number(value.toPrecision(3));
}

function showNumbers({ epsilon, phi, zeta }) {
  document.querySelector('.headline .numbers').replaceChildren(term('epsilon', 'ε'), ` = ${number(epsilon)}, `, term('Phi', 'Φ'), ` = ${number(phi)}, `, term('zeta', 'ζ'), ` = ${number(zeta)}`);
}

// The answer of the comparison; until it is there the estimate, and how far the comparison is.
class Verdict {
  constructor() {
    this.box = document.querySelector('#verdict');
    this.bar = this.box.querySelector('progress');
  }

  show(valid, text, share) {
    this.box.className = `headline ${valid ? (valid === 'partly' ? 'open' : valid) : 'none'}`;
    this.box.querySelector('.sign').textContent = SIGNS[valid] || '…';
    this.box.querySelector('.sentence').textContent = text;
    this.bar.hidden = share === undefined;
    if (share === undefined) this.bar.removeAttribute('value'); else this.bar.value = share;
  }

  waiting() {
    this.box.dataset.valid = '';
    this.box.dataset.estimate = '';
    this.estimate = undefined;
    this.show(undefined, 'Waiting for the scene to stand', 0);
    this.quantities([]);
  }

  estimated(estimate) {
    this.estimate = estimate;
    this.box.dataset.estimate = estimate.negligible;
    this.comparing({ share: 0 });
  }

  comparing({ share }) {
    if (this.box.dataset.valid) return;
    const { estimate } = this;
    this.show(estimate?.negligible, estimate ? `Estimate: ${estimate.sentence} The comparison is under way.` : 'Comparing the backends on the whole scene', share);
    this.bar.title = `${Math.round(100 * share)} % of the comparison`;
  }

  judged(verdict) {
    this.box.dataset.valid = verdict.valid;
    this.show(verdict.valid, verdict.answer);
    this.quantities(verdict.quantities);
    if (verdict.numbers) showNumbers(verdict.numbers);
  }

  quantities(all) {
    const times = (share) => (share === null ? '–' : `${number(share)}×`);
    const named = all.map(([name, effect, error, words]) => element('span', { class: effect > 1 ? 'beyond' : 'within' },
      element('b', {}, name), ` ${words}: `, term('inertia effect', 'inertia'), ` ${times(effect)}, `, term('engine error', 'engine'), ` ${times(error)}`));
    this.box.querySelector('.quantities').replaceChildren(...named, ...(all.length ? [element('span', { class: 'note' }, 'in multiples of the ', term('tolerance'))] : []));
  }
}

function connect() {
  const socket = new WebSocket(`ws://${location.host}/socket${location.search}`);
  const send = (ask) => { if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(ask)); };
  let live;
  const keeper = new Keeper(send, (saved, keepsTime) => (live ? live.open(saved, keepsTime) : send({ do: 'open', saved })));
  const panel = new Panel(document.querySelector('aside.panel'), { send, change: (ask, isNew) => { if (isNew) live.hold(); send(ask); }, live: () => live });
  const verdict = new Verdict();
  const acts = {
    scene(scene) {
      document.querySelector('h1').textContent = scene.name;
      document.title = `${scene.name}, live`;
      if (live) live.adopt(scene); else live = new Live(document.querySelector('figure.replay'), scene, send, keeper);
      panel.show(scene);
      showNumbers(scene.numbers);
      verdict.waiting();
      keeper.changed();
    },
    frame: (frame) => live.frame(frame),
    estimate: (estimate) => verdict.estimated(estimate),
    comparing: (progress) => verdict.comparing(progress),
    verdict: (judged) => verdict.judged(judged),
    saved: async (saved) => { await keeper.take(saved); if (live.editor.isOn) live.editor.accept(saved.scenario); },
    handed: () => told('The scene is handed back.'),
    refused({ why }) { told(why); live?.editor.answered(false); },
  };
  socket.addEventListener('message', ({ data }) => { const message = JSON.parse(data); acts[message.tell](message); });
  socket.addEventListener('open', async () => {
    try {
      const saved = await keeper.ofAddress();
      if (saved) { send({ do: 'open', saved }); return; }
    } catch {
      told('The link is damaged: it must be one that this page copied.');
    }
    const { stored } = keeper;
    if (stored) told(`“${stored.name}” was changed here on ${new Date(stored.when).toLocaleString()}.`, { acts: [['Open it again', () => keeper.open(stored.saved)]], lasts: 20000 });
  });
  socket.addEventListener('close', ({ reason }) => {
    document.body.dataset.closed = reason || 'closed';
    told(`${reason ? `The server closed this page: ${reason}.` : 'The server has ended, or this page is too old.'} Start \`cohaul view\` again and open its link; the last change is kept in this browser.`);
  });
}

scheme.begin();
connect();
