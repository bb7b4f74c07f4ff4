// Changes the scene itself: its parts are taken in the drawing or out of a list, and every number can be typed.

const GRIP_COLORS = { waypoint: '#cc3311', obstacle: '#7b3fa0', point: '#7b3fa0', part: '#7b3fa0', spring: '#d55e00', support: '#e69f00', nest: '#009e73', load: '#0072b2' };
const ADD_WORDS = { box: 'Box', disc: 'Disc', wall: 'Wall', pusher: 'Pusher', spring: 'Spring', support: 'Support' };
// Numbers of a longer list are not shown; its points are taken one by one.
const LONGEST_LIST = 12;

class Editor {
  // `ask` hands a scenario to the server, `redraw` draws again.
  constructor({ ask, redraw }) {
    Object.assign(this, { ask, redraw, isOn: false });
    this.box = element('div', { class: 'editor', hidden: '' });
    this.parts = element('select', { name: 'part', 'aria-label': 'Part of the scene' });
    this.parts.addEventListener('change', () => this.select(this.parts.value === '' ? undefined : this.grips[Number(this.parts.value)]));
    this.fields = element('div', { class: 'fields' });
    const adders = Object.entries(ADD_WORDS).map(([kind, word]) => button(word, `Adds one: ${word.toLowerCase()}`, () => this.add((scene) => ADDERS[kind](scene, this.beside(), this.size)), 'add'));
    this.ants = [button('Ant', 'One ant more', () => this.addAnt(1), 'add'), button('− Ant', 'One ant less', () => this.addAnt(-1))];
    const point = button('Point', 'A point or waypoint after the one that is chosen; a spring or an obstacle that is chosen begins to move', () => this.add((scene) => addPoint(scene, this.chosen?.at, this.size)), 'add');
    this.remover = button('Remove', 'Takes the chosen part out (Delete)', () => this.remove());
    this.box.append(element('h2', {}, 'Edit the scene'), element('div', { class: 'scenes' }, element('span', {}, 'Add '), ...adders, point, ...this.ants),
      element('div', { class: 'scenes' }, this.parts, this.remover), this.fields);
  }

  // Begins with a scenario, or ends without one.
  show(scene) {
    this.isOn = scene !== undefined;
    this.box.hidden = !this.isOn;
    if (!this.isOn) return;
    this.accept(scene);
  }

  // The scenario as the server has it.
  accept(scene) {
    this.good = scene;
    if (this.grabbed || this.isAsking) return;
    this.scene = structuredClone(scene);
    for (const ant of this.ants) ant.hidden = scene.drive.kind !== 'ants';
    this.list();
  }

  get size() {
    return radiusOf(this.scene.load);
  }

  // Beside the load, where there is room for something new (m).
  beside() {
    const [x, y] = this.scene.load.position_m || [0, 0];
    return [x + 3.5 * this.size, y + 2.5 * this.size * ((this.scene.obstacles?.length || 0) % 3 - 1)];
  }

  // The grips, with the chosen one in the list of parts.
  list(at = this.chosen?.at, name = this.chosen?.name) {
    this.grips = gripsOf(this.scene);
    const key = JSON.stringify(at);
    const same = at && this.grips.filter((grip) => JSON.stringify(grip.at) === key);
    this.chosen = same && (same.find((grip) => grip.name === name) || same[0]);
    this.parts.replaceChildren(element('option', { value: '' }, 'the scene'), ...this.grips.map((grip, i) => element('option', { value: i }, grip.name)));
    this.parts.value = this.chosen ? this.grips.indexOf(this.chosen) : '';
    this.remover.disabled = !this.chosen;
    if (!this.fields.contains(document.activeElement)) this.showFields();
  }

  select(grip) {
    this.chosen = grip;
    this.list();
    this.showFields();
    this.redraw();
  }

  // The grip nearest to a place of a view, if it is near.
  nearest(scale, x, y) {
    const away = ({ place }) => { const [px, py] = scale.to(...place); return Math.hypot(px - x, py - y); };
    const near = this.grips.map((grip) => [away(grip), grip]).filter(([distance]) => distance < NEAR);
    // A place of several is that of the chosen one.
    return (near.find(([distance, grip]) => grip === this.chosen && distance < NEAR / 3) || near.sort(([a], [b]) => a - b)[0])?.[1];
  }

  take(scale, x, y) {
    const grip = this.nearest(scale, x, y);
    if (!grip) return false;
    this.select(grip);
    const [px, py] = scale.to(...grip.place);
    this.grabbed = { off: [px - x, py - y], scale, hasMoved: false };
    return true;
  }

  carry(x, y) {
    const { off, scale } = this.grabbed;
    this.grabbed.hasMoved = true;
    this.chosen.move(this.scene, scale.from(x + off[0], y + off[1]));
    this.list();
    this.apply();
  }

  letGo() {
    this.grabbed = undefined;
    this.showFields();
  }

  add(change) {
    const at = change(this.scene);
    if (!at) { told('Choose a point, a waypoint, a spring or an obstacle first.'); return; }
    this.chosen = undefined;
    this.list(at);
    this.showFields();
    this.apply();
  }

  addAnt(by) {
    this.scene.drive.n_ants = Math.max(this.scene.drive.n_ants + by, 1);
    this.showFields();
    this.apply();
  }

  remove() {
    if (!this.chosen) return;
    if (!removePart(this.scene, this.chosen.at)) { told('This part cannot be removed.'); return; }
    this.chosen = undefined;
    this.list();
    this.showFields();
    this.apply();
  }

  // One scene at a time is on its way to the server; the last one follows.
  apply() {
    this.redraw();
    this.isWaiting = this.isAsking;
    if (this.isAsking) return;
    this.isAsking = true;
    this.sent = structuredClone(this.scene);
    this.ask(this.sent);
  }

  // The server has taken the scene, or has refused it.
  answered(isTaken) {
    if (!this.isAsking) return;
    this.isAsking = false;
    if (isTaken) this.good = this.sent;
    if (this.isWaiting) this.apply();
    else if (!isTaken && !this.grabbed) {
      this.accept(this.good);
      this.showFields();
    }
  }

  // Fields of the chosen part, or of the scene as a whole.
  showFields() {
    const { scene, chosen } = this;
    const but = (object, ...left) => Object.fromEntries(Object.entries(object).filter(([key]) => !left.includes(key)));
    this.fields.replaceChildren(...(chosen ? this.rowsOf(valueAt(scene, chosen.at), chosen.at) : [
      ...this.rowsOf(but(scene, 'ground', 'drive', 'obstacles', 'springs', 'load'), []),
      ...this.rowsOf(but(scene.ground, 'supports'), ['ground']), ...this.rowsOf(but(scene.drive, 'paths'), ['drive'])]));
  }

  // A field for each number and each word in a value.
  rowsOf(value, at) {
    if (Array.isArray(value) && value.length > LONGEST_LIST) return [];
    if (value !== null && typeof value === 'object') return Object.entries(value).flatMap(([key, inner]) => this.rowsOf(inner, [...at, Array.isArray(value) ? Number(key) : key]));
    if (at[0] === 'format' || at.at(-1) === 'kind') return [];
    const isNumber = typeof value === 'number';
    const input = element('input', { name: at.join('.'), ...(isNumber ? { type: 'number', step: 'any' } : { type: 'text' }) });
    input.value = value;
    input.addEventListener('change', () => {
      if (isNumber && !Number.isFinite(input.valueAsNumber)) { input.value = valueAt(this.scene, at); return; }
      parentOf(this.scene, at)[at.at(-1)] = isNumber ? input.valueAsNumber : input.value;
      this.list();
      this.apply();
    });
    return [element('label', { class: 'pair' }, `${this.words(at)} `, input)];
  }

  // The keys below the chosen part, with the coordinates of a point by name.
  words(at) {
    const below = at.slice(this.chosen ? this.chosen.at.length : at.length - 1);
    const axes = at.includes('waypoints') ? ['time_s', 'x_m', 'y_m', 'heading_rad'] : ['x', 'y'];
    const last = at.at(-1);
    if (typeof last === 'number') below.splice(-1, 1, axes[last] ?? last);
    // Long keys may break after an underscore.
    return below.join(' ').replaceAll('_', '_\u200b');
  }

  // The grips in a view, the chosen one filled.
  draw(pen, scale) {
    for (const grip of this.grips) {
      const [x, y] = scale.to(...grip.place);
      const color = GRIP_COLORS[grip.kind];
      pen.lineWidth = 2;
      pen.strokeStyle = color;
      pen.fillStyle = grip === this.chosen ? color : scheme.look.back;
      pen.beginPath();
      if (grip.kind === 'point') pen.rect(x - 4, y - 4, 8, 8); else pen.arc(x, y, grip.kind === 'load' ? 8 : 5, 0, 2 * Math.PI);
      pen.fill();
      pen.stroke();
    }
    if (this.chosen) {
      const [x, y] = scale.to(...this.chosen.place);
      write(pen, this.chosen.name, x + 12, y - 8, 'left', scheme.look.ink, '600 13px');
    }
  }
}
