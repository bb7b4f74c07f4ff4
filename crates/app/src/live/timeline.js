// The drawing of the live page in time: shows what the server has sent at any time, and asks it to go on.

const PACES = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20];
// A scene lasts at least this long at its first pace (s).
const LASTS = 4;
const KEYS = 'Keys: space plays, ← → a step, Home and End, + − zoom, w a s d move, 0 resets, Ctrl+Z undoes.';
// Handles within this of the pointer are taken (px).
const NEAR = 26;
// A path so many times as long as the load is wide is not shown as a whole at first.
const FAR = 40;

function isTyping(target) {
  return /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName) && target.type !== 'range' && target.type !== 'checkbox';
}

class Timeline extends Stage {
  constructor(figure, scene, send, keeper) {
    super(readReplay(scene.replay.data));
    Object.assign(this, { figure, send, keeper, keys: KEYS, what: 'drawing', start: 0, time: 0, nDrawn: 0, isLive: true, isPlaying: false });
    this.isOverlaid = figure.clientWidth < 640 && this.data.runs.length > 1;
    this.editor = new Editor({ ask: (scenario) => this.edit(scenario), redraw: () => this.draw() });
    this.adopt(scene);
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    scheme.listeners.push(() => this.resize());
    document.addEventListener('keydown', (event) => this.onKey(event));
  }

  // The scene after a change: its course begins anew, and the time and the view stay.
  adopt(scene) {
    const before = this.scene;
    const isOther = !before || before.name !== scene.name;
    const { springs } = this.data;
    this.scene = scene;
    if (before) this.data = readReplay(scene.replay.data);
    const whole = this.whole;
    this.whole = this.extentOfAll();
    if (before && !isOther) {
      if (this.editor.isOn) this.whole = whole; else this.widen(...whole);
    }
    this.reach = this.reachOfSprings();
    this.course = new Course(this.data.runs.map(({ label }) => label), this.data.radius);
    // What the canvas says of itself is of the earlier scene.
    for (const said of Object.keys(this.canvas?.dataset || {})) delete this.canvas.dataset[said];
    if (this.server) this.server = { ...this.server, has_ended: false };
    if (isOther) this.begin();
    this.opensAt = undefined;
    const shape = (of, drawn) => JSON.stringify([of.name, of.ants_on, of.settings.backends, of.replay.data.obstacles?.length > 0, drawn.length]);
    if (!before || shape(before, springs) !== shape(scene, this.data.springs)) {
      [this.base, this.factor] = [0, 1];
      if (this.data.runs.length < 2) this.isOverlaid = false;
      this.build();
    }
    this.showCourse();
    this.editor.answered(true);
  }

  // Another scene is seen as a whole from its start, at a pace that leaves time to see it.
  begin() {
    this.resetView();
    const [left, bottom, right, top] = this.whole;
    this.follows = Math.max(right - left, top - bottom) > 2 * FAR * this.data.radius;
    this.earlier = undefined;
    this.goal = this.opensAt ?? 0;
    [this.time, this.isLive, this.isPlaying] = [this.goal, true, false];
    this.setPace(PACES.findLast((pace) => pace <= Math.max(Math.min(this.scene.duration_s / LASTS, 1), PACES[0])));
  }

  setPace(pace) {
    this.pace = pace;
    this.send({ do: 'pace', factor: pace });
    if (this.paces) this.paces.querySelector('select').value = pace;
  }

  // Before a change: the course so far stays in view, pale, unless the one before it got further.
  hold(before = 'the last change') {
    if (this.course.end > 0 && this.course.end >= (this.goal ?? 0) - 1e-9) this.earlier = Object.assign(this.course, { before });
    this.goal = this.course.end;
  }

  // A command that changes the scene.
  change(ask) {
    this.hold();
    this.send(ask);
  }

  // A state as it was kept: at its own time, or at the time that is shown of the same scene.
  open(saved, keepsTime) {
    this.hold(keepsTime ? 'Undo or Redo' : undefined);
    this.isPlaying = false;
    if (keepsTime && saved.scenario.name === this.scene.name) {
      this.send({ do: 'open', saved: { ...saved, time_s: this.goal } });
      return;
    }
    [this.opensAt, this.goal, this.time, this.isLive] = [saved.time_s, saved.time_s, saved.time_s, true];
    this.send({ do: 'open', saved });
  }

  edit(scenario) {
    [this.earlier, this.goal, this.time, this.isLive] = [undefined, 0, 0, true];
    this.send({ do: 'open', saved: { scenario, settings: this.scene.settings, time_s: 0 } });
  }

  build() {
    this.canvas ??= this.makeCanvas();
    this.signs = element('div', { class: 'key' }, ...this.key(), this.keys);
    this.track = element('input', { type: 'range', min: 0, step: 'any', 'aria-label': 'Time (s)' });
    this.track.addEventListener('input', () => this.goTo(Number(this.track.value)));
    const [ofTime, ofView] = [this.timeControls(), this.viewControls()].map((controls) => element('div', { class: 'controls' }, ...controls));
    this.videoButton.title = 'Records what is drawn until it is pressed again';
    const view = element('details', { class: 'of-view' }, element('summary', {}, 'View, signs and files'), ofView, this.signs);
    view.open = this.isViewOpen ?? this.figure.clientWidth > 640;
    view.addEventListener('toggle', () => { this.isViewOpen = view.open; });
    this.figure.querySelector('.stage').replaceChildren(this.canvas, element('div', { class: 'track' }, this.track), ofTime, this.share, view);
    const has = { pull: this.data.springs.length, force: this.data.obstacles.length, apart: this.data.runs.length > 1 };
    const quantities = QUANTITIES.filter(([key]) => has[key] ?? true);
    this.plots = quantities.map(([key, y, unit], at) => {
      const curves = this.data.runs.map(({ label, color }) => ({ key, label, color, width: 1.6, dash: '', steps: false, x: [], y: [] }));
      return new Plot({ x: 'time (s)', y, unit, scale: 'from_zero', curves: key === 'apart' ? curves.slice(1) : curves, levels: [], instants: [] }, at + 1, this);
    });
    document.querySelector('figure.curves .plots').replaceChildren(...this.plots.map((plot) => plot.box));
    this.resize();
  }

  // Drawing and plots hold the lists of the course.
  showCourse() {
    this.data.runs.forEach((run, i) => Object.assign(run, this.course.runs[i]));
    for (const curve of this.plots.flatMap((plot) => plot.panel.curves)) {
      const of = (course) => { const run = course?.runs[course.labels.indexOf(curve.label)]; return run && { x: run.times, y: run[curve.key] }; };
      Object.assign(curve, of(this.course), { before: of(this.earlier) });
    }
    this.isStale = true;
  }

  makeCanvas() {
    this.canvas = element('canvas', { role: 'img', tabindex: '0', 'aria-label': 'Drawing of the load on each backend; what the pointer takes is dragged' });
    this.share = element('p', { class: 'note share' });
    this.listenToPointer();
    this.canvas.addEventListener('dblclick', (event) => this.release(event));
    return this.canvas;
  }

  get isShared() {
    return !this.scene.ants_on;
  }

  // End of all that is shown of time (s): a drag may go on beyond that of the scene.
  get end() {
    return Math.max(this.course.end, this.earlier?.end ?? 0);
  }

  get lasts() {
    return Math.max(this.scene.duration_s, this.course.end);
  }

  // Shows a time: at once if it was computed, else as soon as the runs are there.
  goTo(time) {
    this.pause();
    if (this.editor.isOn && time > 0) this.setEditing(false);
    this.time = Math.min(Math.max(time, 0), this.lasts);
    this.isLive = this.time >= this.course.end;
    if (this.time > this.course.end) this.send({ do: 'go-to', time_s: this.time });
    this.draw();
  }

  timeControls() {
    this.playButton = button('Play', 'Space', () => this.toggle(), 'play');
    this.clock = element('span', { class: 'time' });
    this.paces = this.choice('pace', PACES.map((pace) => [pace, `${pace}×`]), this.pace, (pace) => this.setPace(pace));
    const controls = [this.playButton, this.clock,
      button('◂', 'One instant back (left arrow)', () => this.step(-1)), button('▸', 'One instant on (right arrow)', () => this.step(1)),
      button('Restart', 'Back to the start, with all that was dragged (Home)', () => this.goTo(0)), this.paces];
    if (this.scene.has_ants) {
      const ants = button('Ants', 'Ants that decide for themselves; without them all tips can be dragged', () => this.change({ do: 'ants', on: !this.scene.ants_on }), 'ants');
      ants.setAttribute('aria-pressed', this.scene.ants_on);
      controls.push(ants);
    }
    const edit = button('Edit', 'Add, move, reshape and remove parts of the scene', () => this.setEditing(!this.editor.isOn), 'edit');
    edit.setAttribute('aria-pressed', this.editor.isOn);
    this.editButton = edit;
    return [...controls, edit, this.keeper.undoButton, this.keeper.redoButton,
      button('Save scenario', 'Saves the scene with all that was dragged as a scenario file', () => this.keeper.ask((saved) => this.saveFile(saved))),
      button('Copy link', 'A link to this page as it stands now', () => this.keeper.ask(() => this.copyLink())),
      ...('handsBack' in document.body.dataset ? [button('Hand back', 'Returns this scene to the program that opened the page, and ends', () => this.send({ do: 'hand-back' }), 'hand')] : [])];
  }

  saveFile(saved) {
    this.canvas.dataset.saved = JSON.stringify(saved);
    save(new Blob([`${JSON.stringify(saved.scenario, null, 2)}\n`], { type: 'application/json' }), 'scenario.json');
  }

  async copyLink() {
    const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    told(isCopied ? 'The link is copied.' : 'The link stands in the address bar.');
  }

  record() {
    if (this.recorder) this.recorder.stop(); else this.startVideo('live');
  }

  toggle() {
    if (this.editor.isOn) this.setEditing(false);
    if (this.isPlaying) { this.pause(); return; }
    if (this.server.has_ended && this.time >= this.course.end) this.time = 0;
    this.play();
  }

  play() {
    this.isPlaying = true;
    this.last = undefined;
    this.follow();
    this.wake();
  }

  pause() {
    if (this.server?.is_playing) this.send({ do: 'pause' });
    if (this.isPlaying) this.keeper.changed();
    this.isPlaying = false;
    if (this.isLive) this.time = this.course.end;
    this.wake();
  }

  // To the next instant or the one before; beyond the last the runs go on.
  step(by) {
    this.pause();
    const { times, end } = this.course;
    if (by > 0 && this.time >= end) { this.isLive = true; this.send({ do: 'step' }); return; }
    const at = indexAt(times, this.time);
    this.goTo(times[Math.max(by < 0 && this.time > times[at] ? at : at + by, 0)] ?? 0);
  }

  onKey(event) {
    if (isTyping(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const isControl = /^(BUTTON|SUMMARY|INPUT|A)$/.test(event.target.tagName);
    const pan = 0.1 * this.grid.height;
    const acts = {
      ' ': () => this.toggle(),
      ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1), Home: () => this.goTo(0), End: () => this.goTo(this.course.end),
      '+': () => this.zoomBy(ZOOM.step), '-': () => this.zoomBy(1 / ZOOM.step),
      0: () => { this.resetView(); this.draw(); },
      w: () => this.panBy(0, pan), s: () => this.panBy(0, -pan), a: () => this.panBy(pan, 0), d: () => this.panBy(-pan, 0),
      Delete: () => this.editor.isOn && this.editor.remove(),
    };
    if (!acts[event.key] || (isControl && event.key === ' ') || (event.target.type === 'range' && /^(Arrow|Home|End)/.test(event.key))) return;
    event.preventDefault();
    acts[event.key]();
  }

  // Takes a frame; it is drawn when the browser draws next.
  frame(now) {
    this.server = now;
    if (this.course.add(now)) this.measure(now);
    this.follow();
    this.wake();
  }

  // The last frame is shown while nothing else is, and a drag or a play at the end goes on with the server.
  follow() {
    const { end } = this.course;
    if (this.isLive && !this.isPlaying && end > 0) this.time = this.goal > end && !this.server.has_ended ? this.time : end;
    if (!this.isPlaying || this.time < end || (this.goal > end + 1e-9 && !this.server.has_ended)) return;
    this.isLive = true;
    if (this.server.has_ended && !this.grab) { this.isPlaying = false; this.time = end; this.keeper.changed(); }
    else if (!this.server.is_playing && !this.grab) this.send({ do: 'play' });
  }

  // Draws with the browser: once, or as long as it plays.
  wake() {
    this.pending ??= requestAnimationFrame((at) => {
      this.pending = undefined;
      if (!this.server || !this.course.frames.length) return;
      this.tick(at);
      this.count(at);
      this.draw();
      if (this.answered !== this.server.frame) this.send({ do: 'drawn', frame: this.answered = this.server.frame });
      if (this.isPlaying) this.wake();
    });
  }

  // The clock of what is shown runs at the pace towards the end of the course, and is not left behind by it.
  tick(at) {
    const passed = this.last === undefined ? 0 : Math.min((at - this.last) / 1000, 0.1);
    this.last = at;
    const { end } = this.course;
    if (!this.isPlaying || this.time >= end) { this.follow(); return; }
    this.time = Math.min(this.time + this.pace * passed, end);
    const behind = Math.max(2.5 * this.scene.control_period_s, 0.1 * this.pace);
    if (this.isLive && this.server.is_playing && end - this.time > behind) this.time = end - behind / 2;
    this.follow();
  }

  // Scales of what is drawn, which grow with it, and what is seen of the whole path.
  measure(now) {
    const { data } = this;
    for (const { pose, twist, pulls, contacts } of now.lanes) {
      for (const pull of pulls) data.largest_pull = Math.max(data.largest_pull, pull || 0);
      for (const [, , fx, fy] of contacts) data.force_unit = Math.max(data.force_unit, Math.hypot(fx, fy));
      if (twist) data.slip_unit = Math.max(data.slip_unit, Math.hypot(twist[0], twist[1]) + data.radius * Math.abs(twist[2]));
      const around = this.reach / 1.7;
      if (pose) this.widen(pose[0] - around, pose[1] - around, pose[0] + around, pose[1] + around);
    }
    for (const tip of now.stages.flatMap(({ tips }) => tips)) if (tip) this.widen(tip[0], tip[1], tip[0], tip[1]);
    for (const run of data.runs) run.sticks_below = Math.max(1e-4 * data.slip_unit, data.rest_below);
    this.isStale = true;
  }

  widen(left, bottom, right, top) {
    const box = this.whole;
    this.whole = [Math.min(box[0], left), Math.min(box[1], bottom), Math.max(box[2], right), Math.max(box[3], top)];
  }

  count(at) {
    this.recent = [...(this.recent || []).filter((time) => time > at - 1000), at];
    const { share } = this.server;
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
    return {
      run, x, y, heading, vx, vy, rate, contacts: lane.contacts, place: this.now.place,
      tips: stage.tips.map((tip) => tip || [NaN, NaN]),
      ants: stage.ants.map(([ax, ay, turn, holds]) => ({ x: ax, y: ay, heading: turn, holds: holds > 0 })),
      pulls: lane.pulls.map((pull) => pull ?? NaN),
    };
  }

  poseOf(obstacle) {
    const at = this.scene.pushers.indexOf(this.data.obstacles.indexOf(obstacle));
    if (at < 0 || !this.now) return super.poseOf(obstacle);
    const [x, y, heading] = this.now.pushers[at];
    return { x, y, heading };
  }

  draw() {
    if (!this.course.frames.length || !this.grid) return;
    this.now = this.course.at(this.time);
    const states = this.data.runs.map((run) => this.stateOf(run));
    this.states = states;
    this.drawAll(this.canvas, states);
    this.drawPlots();
    this.tell(states);
  }

  // One plot after another while the load moves: all of them would take longer than a frame.
  drawPlots() {
    if (!this.isStale) this.plots.forEach((plot) => plot.draw());
    else if (this.isPlaying) this.plots[this.nDrawn % this.plots.length].refresh();
    else { this.plots.forEach((plot) => plot.refresh()); this.isStale = false; }
  }
}
