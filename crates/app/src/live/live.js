// The live page: draws what the server sends, and asks it for what the reader does.

const PACES = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20];
const KEYS = 'Drag a tip or a pusher to pull the load on all backends; the tip stays where it is dropped. Double-click an attached tip to let go. '
  + 'Keys: space plays, → a step, Home to the start, + − zoom, w a s d move, 0 resets.';
// Handles within this of the pointer are taken (px).
const NEAR = 26;
const MOST_POINTS = 4000;
const QUANTITIES = [
  ['pull', 'largest pull (N)', 'from_zero'], ['force', 'largest force of an obstacle (N)', 'from_zero'], ['speed', 'edge speed (m/s)', 'from_zero'],
  ['kinetic', 'kinetic energy (J)', 'from_zero'], ['dissipated', 'energy dissipated (J)', 'from_zero'],
  ['apart', 'edge displacement from the first (m)', 'from_zero'],
];
const SIGNS = { yes: '✓', no: '✗', partly: '~', open: '?' };

class Live extends Stage {
  constructor(figure, scene, send) {
    super(readReplay(scene.replay.data));
    Object.assign(this, { figure, send, keys: KEYS, what: 'drawing', start: 0, end: 0, nDrawn: 0 });
    this.adopt(scene);
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    scheme.listeners.push(() => this.resize());
    figure.addEventListener('keydown', (event) => this.onKey(event));
  }

  // The scene after a change: what is drawn begins anew, and the view stays.
  adopt(scene) {
    const before = this.scene;
    this.scene = scene;
    if (before) this.data = readReplay(scene.replay.data);
    this.whole = this.extentOfAll();
    this.reach = this.reachOfSprings();
    this.now = undefined;
    this.clear();
    // What the canvas says of itself is of the earlier scene.
    for (const said of Object.keys(this.canvas?.dataset || {})) delete this.canvas.dataset[said];
    const shape = ({ name, ants_on: on, settings, replay }) => JSON.stringify([name, on, settings.backends, replay.data.springs?.length]);
    if (before && shape(before) === shape(scene)) return;
    if (!before || before.name !== scene.name) this.resetView();
    this.base = 0;
    this.factor = 1;
    if (this.data.runs.length < 2) this.isOverlaid = false;
    this.build();
  }

  build() {
    this.canvas ??= this.makeCanvas();
    this.signs = element('div', { class: 'key' }, ...this.key(), KEYS);
    const [ofTime, ofView] = [this.timeControls(), this.viewControls()].map((controls) => element('div', { class: 'controls' }, ...controls));
    this.videoButton.title = 'Records what is drawn until it is pressed again';
    this.figure.querySelector('.stage').replaceChildren(this.canvas, ofTime, ofView, this.signs);
    const has = { pull: this.data.springs.length, force: this.data.obstacles.length, apart: this.data.runs.length > 1 };
    const plots = QUANTITIES.filter(([key]) => has[key] ?? true);
    this.plots = plots.map(([key, y, scale], at) => {
      const curves = this.data.runs.map((run) => ({ label: run.label, color: run.color, width: 1.6, dash: '', steps: false, x: run.times, y: run[key] }));
      return new Plot({ x: 'time (s)', y, scale, curves: key === 'apart' ? curves.slice(1) : curves, levels: [], instants: [] }, at + 1, this);
    });
    document.querySelector('figure.curves .plots').replaceChildren(...this.plots.map((plot) => plot.box));
    if (this.canvas.isConnected) this.resize();
  }

  makeCanvas() {
    this.canvas = element('canvas', { role: 'img', tabindex: '0', 'aria-label': 'Drawing of the load on each backend; what the pointer takes is dragged' });
    this.listenToPointer();
    this.canvas.addEventListener('dblclick', (event) => {
      const { spring } = this.nearest(this.pointAt(event)) || {};
      if (spring !== undefined) this.send({ do: 'release', spring });
    });
    return this.canvas;
  }

  // Forgets the course so far. The plots hold these very lists.
  clear() {
    for (const run of this.data.runs) {
      for (const key of ['times', 'x', 'y', ...QUANTITIES.map(([name]) => name)]) run[key] = [];
    }
    (this.plots || []).forEach((plot) => plot.panel.curves.forEach((curve) => {
      const run = this.data.runs.find(({ label }) => label === curve.label);
      const key = QUANTITIES.find(([, y]) => y === plot.panel.y)[0];
      if (run) [curve.x, curve.y] = [run.times, run[key]];
    }));
    [this.end, this.time] = [0, 0];
  }

  get isShared() {
    return !this.scene.ants_on;
  }

  goTo(time) {
    this.send({ do: 'go-to', time_s: Math.max(time, 0) });
  }

  timeControls() {
    this.playButton = button('Play', 'Space', () => this.toggle(), 'play');
    this.clock = element('span', { class: 'time' });
    this.share = element('span', { class: 'note share', title: 'Time that computing takes over the time that is shown' });
    const controls = [this.playButton, this.clock,
      button('▸', 'One control period on (right arrow)', () => this.send({ do: 'step' })),
      button('Restart', 'Back to the start, with all that was dragged (Home)', () => this.send({ do: 'restart' })),
      this.choice('pace', PACES.map((pace) => [pace, `${pace}×`]), this.pace || 1, (pace) => { this.pace = pace; this.send({ do: 'pace', factor: pace }); })];
    if (this.scene.has_ants) {
      const ants = button('Ants', 'Ants that decide for themselves; without them all tips can be dragged', () => this.send({ do: 'ants', on: !this.scene.ants_on }), 'ants');
      ants.setAttribute('aria-pressed', this.scene.ants_on);
      controls.push(ants);
    }
    controls.push(button('Save scenario', 'Saves the scene with all that was dragged as a scenario file', () => this.ask('file')),
      button('Copy link', 'A link to this page as it stands now', () => this.ask('link')), this.share);
    return controls;
  }

  // What is saved comes from the server.
  ask(what) {
    this.wanted = what;
    this.send({ do: 'save' });
  }

  async saved({ format, scenario, settings, time_s }) {
    const saved = { format, scenario, settings, time_s };
    const text = JSON.stringify(saved);
    this.canvas.dataset.saved = text;
    if (this.wanted === 'file') save(new Blob([`${JSON.stringify(saved.scenario, null, 2)}\n`], { type: 'application/json' }), 'scenario.json');
    if (this.wanted === 'link') {
      history.replaceState(null, '', `#s=${await packed(text)}`);
      const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
      told(isCopied ? 'The link is copied.' : 'The link stands in the address bar.');
    }
    this.wanted = undefined;
  }

  record() {
    if (this.recorder) this.recorder.stop(); else this.startVideo('live');
  }

  toggle() {
    this.send({ do: this.now?.is_playing ? 'pause' : 'play' });
  }

  onKey(event) {
    if (/^(INPUT|SELECT)$/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const pan = 0.1 * this.grid.height;
    const acts = {
      ' ': () => this.toggle(),
      ArrowRight: () => this.send({ do: 'step' }),
      Home: () => this.send({ do: 'restart' }),
      '+': () => this.zoomBy(ZOOM.step), '-': () => this.zoomBy(1 / ZOOM.step),
      0: () => { this.resetView(); this.draw(); },
      w: () => this.panBy(0, pan), s: () => this.panBy(0, -pan), a: () => this.panBy(pan, 0), d: () => this.panBy(-pan, 0),
    };
    if (!acts[event.key] || (event.target.tagName === 'BUTTON' && event.key === ' ')) return;
    event.preventDefault();
    acts[event.key]();
  }

  // Takes a frame; it is drawn when the browser draws next, and said to be drawn then.
  frame(now) {
    if (this.now && now.time_s < this.now.time_s) this.clear();
    this.now = now;
    this.time = this.end = now.time_s;
    this.add(now);
    this.pending ??= requestAnimationFrame((at) => {
      this.pending = undefined;
      if (!this.now) return;
      this.count(at);
      this.draw();
      this.send({ do: 'drawn', frame: this.now.frame });
    });
  }

  // Adds the frame to the course.
  add(now) {
    const { data } = this;
    const speeds = now.lanes.map(({ twist }) => (twist ? Math.hypot(twist[0], twist[1]) + data.radius * Math.abs(twist[2]) : NaN));
    for (const lane of now.lanes) {
      for (const pull of lane.pulls) data.largest_pull = Math.max(data.largest_pull, pull || 0);
      for (const [, , fx, fy] of lane.contacts) data.force_unit = Math.max(data.force_unit, Math.hypot(fx, fy));
    }
    data.slip_unit = Math.max(data.slip_unit, ...speeds.filter(Number.isFinite));
    const { times } = data.runs[0];
    if (times.length && now.time_s <= times[times.length - 1]) return;
    const first = now.lanes[0].pose;
    data.runs.forEach((run, i) => {
      const lane = now.lanes[i];
      const { pose, energy } = lane;
      run.sticks_below = 1e-4 * data.slip_unit;
      run.times.push(now.time_s);
      if (pose) this.widen(pose[0], pose[1], 1.3 * data.radius);
      run.x.push(pose ? pose[0] : NaN);
      run.y.push(pose ? pose[1] : NaN);
      run.pull.push(Math.max(0, ...lane.pulls.filter((pull) => pull !== null)));
      run.force.push(Math.max(0, ...lane.contacts.map(([, , fx, fy]) => Math.hypot(fx, fy))));
      run.speed.push(speeds[i]);
      run.kinetic.push(energy ? energy[1] : NaN);
      run.dissipated.push(energy ? energy[2] : NaN);
      run.apart.push(pose && first ? Math.hypot(pose[0] - first[0], pose[1] - first[1]) + data.radius * Math.abs(pose[2] - first[2]) : NaN);
    });
    // Twice as coarse when there are too many.
    if (times.length > MOST_POINTS) {
      for (const run of data.runs) for (const list of [run.times, run.x, run.y, ...QUANTITIES.map(([key]) => run[key])]) list.splice(0, list.length, ...list.filter((_, i) => i % 2 === 0));
    }
  }

  // Takes a place into what is seen of the whole way.
  widen(x, y, around) {
    const box = this.whole;
    this.whole = [Math.min(box[0], x - around), Math.min(box[1], y - around), Math.max(box[2], x + around), Math.max(box[3], y + around)];
  }

  // The scale of the pulls, which grows with them.
  showScale() {
    const text = withPrefix(this.data.largest_pull, 'N');
    const place = this.signs.querySelector('.ramp')?.nextSibling;
    if (place && place.textContent !== text) place.textContent = text;
  }

  count(at) {
    this.recent = [...(this.recent || []).filter((time) => time > at - 1000), at];
    const { share } = this.now;
    if (share !== null) this.busy = this.busy === undefined ? share : 0.9 * this.busy + 0.1 * share;
    this.nDrawn += 1;
  }

  stateOf(run) {
    const at = this.data.runs.indexOf(run);
    const lane = this.now.lanes[at];
    const stage = this.now.stages[Math.min(at, this.now.stages.length - 1)];
    if (lane.pose) run.last = lane.pose;
    const [x, y, heading] = run.last || [0, 0, 0];
    const [vx, vy, rate] = lane.twist || [0, 0, 0];
    const end = Math.max(run.times.length - 1, 0);
    return {
      run, x, y, heading, vx, vy, rate,
      tips: stage.tips.map((tip) => tip || [NaN, NaN]),
      ants: stage.ants.map(([ax, ay, turn, holds]) => ({ x: ax, y: ay, heading: turn, holds: holds > 0 })),
      pulls: lane.pulls.map((pull) => pull ?? NaN),
      contacts: lane.contacts,
      place: { from: end, to: end, share: 0 },
    };
  }

  poseOf(obstacle) {
    const at = this.scene.pushers.indexOf(this.data.obstacles.indexOf(obstacle));
    if (at < 0 || !this.now) return super.poseOf(obstacle);
    const [x, y, heading] = this.now.pushers[at];
    return { x, y, heading };
  }

  // While something is dragged the view stands still.
  scaleOf(followed, width, height) {
    return super.scaleOf(this.grab?.followed || followed, width, height);
  }

  draw() {
    if (!this.now || !this.grid) return;
    const states = this.data.runs.map((run) => this.stateOf(run));
    this.states = states;
    this.drawAll(this.canvas, states);
    if (this.grab) this.send({ do: 'drag', handle: this.grab.handle, to: this.target() });
    // One plot after another while the load moves: all of them would take longer than a frame.
    if (!this.now.is_playing) this.plots.forEach((plot) => plot.refresh());
    else if (this.nDrawn % 2 === 0) this.plots[(this.nDrawn / 2) % this.plots.length].refresh();
    this.tell(states);
  }

  tell(states) {
    const { now, canvas } = this;
    this.showScale();
    this.playButton.textContent = now.is_playing ? 'Pause' : 'Play';
    this.clock.textContent = `${now.time_s.toFixed(3)} of ${this.scene.duration_s.toFixed(2)} s`;
    const failed = now.lanes.flatMap(({ status, cause }, i) => (status === 'ok' ? [] : [`${this.data.runs[i].label}: ${status}, ${cause}`]));
    const share = this.busy === undefined ? '' : `computing takes ${Number((100 * this.busy).toPrecision(2))} % of real time, ${this.recent.length} frames/s`;
    this.share.textContent = [share, ...failed].filter(Boolean).join('; ');
    const scale = this.scaleIn(0);
    const pixels = (place) => scale.to(...place).map(Math.round);
    Object.assign(canvas.dataset, {
      time: now.time_s, frame: now.frame, playing: now.is_playing, ended: now.has_ended, share: this.busy ?? '', fps: this.recent?.length ?? 0,
      poses: JSON.stringify(Object.fromEntries(states.map(({ run, x, y, heading }) => [run.label, [x, y, heading]]))),
      handles: JSON.stringify({ tips: this.tipsOf(0).map(pixels), pushers: now.pushers.map(pixels) }),
    });
  }

  // Tips of a run, at rest where they are free.
  tipsOf(at) {
    const state = this.states[at];
    return this.data.springs.map(([, ends], i) => (Number.isNaN(state.tips[i][0]) ? this.placed(state, ends[2], ends[3]) : state.tips[i]));
  }

  // The view of a run.
  scaleIn(at) {
    const base = this.states[this.base];
    return this.scaleOf(this.isShared || this.isOverlaid ? base : this.states[at], this.grid.width, this.grid.height);
  }

  // Number of the view that the pointer is on, or of one that it came from, and the place in it (px).
  pointAt(event, from) {
    const box = this.canvas.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    const { columns, width, height } = this.grid;
    const on = Math.floor(py / height) * columns + Math.min(Math.floor(px / width), columns - 1);
    const view = from ?? Math.min(Math.max(on, 0), this.isOverlaid ? 0 : this.data.runs.length - 1);
    return { view, x: px - (view % columns) * width, y: py - Math.floor(view / columns) * height };
  }

  nearest({ view, x, y }) {
    if (!this.now || this.states?.length !== this.data.runs.length) return undefined;
    const scale = this.scaleIn(view);
    const away = (place) => { const [px, py] = scale.to(...place); return Math.hypot(px - x, py - y); };
    const tips = this.tipsOf(view).map((place, i) => ({ spring: this.data.springs[i][0], distance: away(place) }));
    const pushers = this.scene.pushers.map((number) => ({ pusher: number, distance: this.distanceTo(number, scale, x, y) }));
    const [found] = [...tips, ...pushers].filter(({ distance }) => distance < NEAR).sort((a, b) => a.distance - b.distance);
    return found;
  }

  // Nothing within a pusher, half the reach beside its edge, and else infinite (px).
  distanceTo(number, scale, x, y) {
    const obstacle = this.data.obstacles[number];
    const path = new Path2D();
    this.trace(path, obstacle.outline, this.poseOf(obstacle), scale);
    this.tester ??= element('canvas', {}).getContext('2d');
    this.tester.lineWidth = NEAR;
    if (this.tester.isPointInPath(path, x, y)) return 0;
    return this.tester.isPointInStroke(path, x, y) ? NEAR / 2 : Infinity;
  }

  // Where what is dragged goes (m): the pointer, and a pusher as far beside it as it was taken.
  target() {
    const { pointer: { view, x, y }, offset } = this.grab;
    const [wx, wy] = this.scaleIn(view).from(x, y);
    return [wx + offset[0], wy + offset[1]];
  }

  take(event) {
    const pointer = this.pointAt(event);
    const found = this.nearest(pointer);
    if (!found) return false;
    if (this.scene.ants_on && found.spring !== undefined) {
      told('The ants move the tips: switch them off to drag one.');
      return false;
    }
    const followed = this.states[this.isShared || this.isOverlaid ? this.base : pointer.view];
    const handle = found.spring === undefined ? { pusher: found.pusher } : { spring: found.spring };
    this.grab = { pointer, handle, followed, offset: [0, 0], wasPlaying: this.now.is_playing };
    if (found.pusher !== undefined) {
      const obstacle = this.data.obstacles[found.pusher];
      const [x, y] = this.target();
      const pose = this.poseOf(obstacle);
      this.grab.offset = [pose.x - x, pose.y - y];
      // The path that was given ends here.
      obstacle.path.splice(1, Infinity, obstacle.path[0]);
    }
    this.send({ do: 'drag', handle, to: this.target() });
    if (!this.grab.wasPlaying) this.send({ do: 'play' });
    this.canvas.style.cursor = 'grabbing';
    return true;
  }

  carry(event) {
    if (!this.grab) {
      if (!event.buttons) this.canvas.style.cursor = this.nearest(this.pointAt(event)) ? 'pointer' : '';
      return false;
    }
    this.grab.pointer = this.pointAt(event, this.grab.pointer.view);
    this.send({ do: 'drag', handle: this.grab.handle, to: this.target() });
    return true;
  }

  letGo() {
    if (!this.grab) return;
    this.send({ do: 'drop' });
    if (!this.grab.wasPlaying) this.send({ do: 'pause' });
    this.grab = undefined;
    this.canvas.style.cursor = '';
  }
}

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

function told(text) {
  document.querySelector('p.told').textContent = text;
}

function number(value) {
  return value === null || value === undefined ? '–' : Number(value.toPrecision(3));
}

function showNumbers({ epsilon, phi, zeta }) {
  document.querySelector('.headline .numbers').textContent = `ε = ${number(epsilon)}, Φ = ${number(phi)}, ζ = ${number(zeta)}`;
}

// The answer of the comparison; without one, what it waits for.
function showVerdict(verdict, waiting) {
  const box = document.querySelector('#verdict');
  box.className = `headline ${verdict ? (verdict.valid === 'partly' ? 'open' : verdict.valid) : 'none'}`;
  box.dataset.valid = verdict ? verdict.valid : '';
  box.querySelector('.sign').textContent = verdict ? SIGNS[verdict.valid] : '…';
  box.querySelector('.sentence').textContent = verdict ? verdict.answer : waiting;
  const times = (share) => (share === null ? '–' : `${number(share)}×`);
  box.querySelector('.quantities').replaceChildren(...(verdict?.quantities || []).map(([name, effect, error, words]) => element('span',
    { class: effect > 1 ? 'beyond' : 'within', title: 'Inertia effect and engine error over the tolerance' },
    element('b', {}, name), ` ${words}: inertia ${times(effect)}, engine ${times(error)}`)));
  if (verdict?.numbers) showNumbers(verdict.numbers);
}

function connect() {
  const socket = new WebSocket(`ws://${location.host}/socket${location.search}`);
  const send = (ask) => { if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(ask)); };
  const panel = new Panel(document.querySelector('aside.panel'), send);
  panel.refused = told;
  let live;
  const acts = {
    scene(scene) {
      document.querySelector('h1').textContent = scene.name;
      document.title = `${scene.name}, live`;
      told('');
      if (live) live.adopt(scene); else live = new Live(document.querySelector('figure.replay'), scene, send);
      panel.show(scene);
      showNumbers(scene.numbers);
      showVerdict(undefined, 'Waiting for the scene to stand');
    },
    frame: (frame) => live.frame(frame),
    comparing: () => showVerdict(undefined, 'Comparing the backends on the whole scene'),
    verdict: (verdict) => showVerdict(verdict),
    saved: (saved) => live.saved(saved),
    refused: ({ why }) => told(why),
  };
  socket.addEventListener('message', ({ data }) => { const message = JSON.parse(data); acts[message.tell](message); });
  socket.addEventListener('open', async () => {
    if (!location.hash.startsWith('#s=')) return;
    try {
      send({ do: 'open', saved: JSON.parse(await unpacked(location.hash.slice(3))) });
    } catch {
      told('The link is damaged: it must be one that this page copied.');
    }
  });
  socket.addEventListener('close', ({ reason }) => {
    document.body.dataset.closed = reason || 'closed';
    told(reason ? `The server closed this page: ${reason}.` : 'The server has ended, or this page is too old. Start `cohaul view` again and open its link.');
  });
}

scheme.begin();
connect();
