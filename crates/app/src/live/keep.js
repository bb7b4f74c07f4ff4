// What the page keeps: each change of the scene is an address of its own, so that Back undoes it and a reload or a link
// opens it again. The last one is also stored in the browser.

const STORED = 'cohaul live';
// A change counts once the scene has stood for this long (ms).
const STANDS = 300;
// Letters of an address at most; a longer state is in the browser's store alone.
const LONGEST = 1 << 20;

// Bytes of a text as letters that a link may have, compressed; and back.
async function packed(text) {
  const bytes = new Uint8Array(await new Response(new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'))).arrayBuffer());
  let letters = '';
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

async function unpacked(letters) {
  const bytes = Uint8Array.from(atob(letters.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'))).text();
}

// Texts that the browser keeps, as far as it has room and is allowed to.
const store = {
  get(key) {
    try { return localStorage.getItem(key); } catch { return null; }
  },
  set(key, text) {
    try { localStorage.setItem(key, text); } catch { /* The page works without. */ }
  },
};

// What makes two states the same, at whichever time they are seen.
function identity({ time_s: _, ...rest }) {
  return JSON.stringify(rest);
}

class Keeper {
  // `open` shows a state, at the time that is shown if it is told so.
  constructor(send, open) {
    Object.assign(this, { send, open, at: history.state?.at ?? 0, most: history.state?.most ?? 0, waiting: [] });
    const press = (act) => (event) => { event.preventDefault(); act(); };
    this.undoButton = button('Undo', 'Back to the scene before the last change (Ctrl+Z, or Back)', () => this.go(-1));
    this.redoButton = button('Redo', 'On again (Ctrl+Y, or Forward)', () => this.go(1));
    window.addEventListener('popstate', () => this.follow());
    document.addEventListener('keydown', (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.altKey || isTyping(event.target)) return;
      const key = event.shiftKey && event.key.toLowerCase() === 'z' ? 'y' : event.key.toLowerCase();
      if (key === 'z') press(() => this.go(-1))(event);
      if (key === 'y') press(() => this.go(1))(event);
    });
    this.show();
  }

  // The scene is another one, or is seen at another time.
  changed() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => { this.timer = undefined; this.ask(); }, STANDS);
  }

  // Asks for the state, and hands it to `act`.
  ask(act = () => {}) {
    this.waiting.push(act);
    this.send({ do: 'save' });
  }

  // Takes the state that was asked for.
  async take({ tell: _, ...saved }) {
    const act = this.waiting.shift();
    const text = JSON.stringify(saved);
    const letters = await packed(text);
    const isNew = !this.isGiven && this.last !== undefined && identity(saved) !== identity(this.last);
    [this.last, this.isGiven] = [saved, false];
    if (isNew) {
      this.at += 1;
      this.most = this.at;
      store.set(STORED, JSON.stringify({ when: Date.now(), name: saved.scenario.name, saved }));
    }
    if (letters.length < LONGEST) {
      const state = { at: this.at, most: this.most };
      if (isNew) history.pushState(state, '', `#s=${letters}`); else history.replaceState(state, '', `#s=${letters}`);
    }
    this.show();
    act?.(saved);
  }

  // The state of the address; none without one.
  async ofAddress() {
    return location.hash.startsWith('#s=') ? JSON.parse(await unpacked(location.hash.slice(3))) : undefined;
  }

  // What was stored by an earlier page, with its name and time.
  get stored() {
    try { return JSON.parse(store.get(STORED)) ?? undefined; } catch { return undefined; }
  }

  go(by) {
    if (by < 0 ? this.at === 0 && this.timer === undefined : this.at >= this.most) return;
    if (this.timer === undefined) { history.go(by); return; }
    // The last change is not kept yet.
    clearTimeout(this.timer);
    this.timer = undefined;
    this.ask(() => { if (by > 0 || this.at > 0) history.go(by); });
  }

  // Opens what the address holds after Back and Forward.
  async follow() {
    this.at = history.state?.at ?? 0;
    this.most = Math.max(this.most, this.at);
    const saved = await this.ofAddress().catch(() => undefined);
    if (!saved) return;
    this.isGiven = true;
    this.open(saved, true);
    this.show();
  }

  show() {
    this.undoButton.disabled = this.at === 0;
    this.redoButton.disabled = this.at >= this.most;
  }
}
