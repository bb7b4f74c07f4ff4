// A replay with its controls: time, what is seen, and files of it.

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100];
const REMARKABLE = ['grasp', 'release', 'slip_onset', 'stop', 'pinning', 'unpinning', 'jump', 'touch', 'separation', 'side_stick', 'side_slip', 'impact', 'not_unique', 'squeeze'];
const KEYS = 'Keys: space plays, ← → an instant, shift a second, [ ] events, + − zoom, w a s d move, 0 resets. The wheel zooms once the drawing is clicked, or with ctrl; dragging moves it.';

class Player extends Stage {
  constructor(figure, data) {
    super(data);
    this.figure = figure;
    this.keys = KEYS;
    this.what = 'replay';
    this.end = Math.max(...data.runs.map((run) => run.times[run.times.length - 1]));
    this.start = Math.min(...data.runs.map((run) => run.times[0]));
    this.time = Math.min(Math.max(data.opens_at, this.start), this.end);
    const wish = (this.end - this.start) / 20;
    this.speed = SPEEDS.reduce((best, speed) => (Math.abs(Math.log(speed / wish)) < Math.abs(Math.log(best / wish)) ? speed : best), 1);
    this.loops = true;
    this.playing = false;
    // Called with the time whenever it changes.
    this.followers = [];
    this.marks = this.collectMarks();
    this.build();
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    scheme.listeners.push(() => this.resize());
    this.resize();
  }

  // Everything that happened, in the order of time; what several runs share once.
  collectMarks() {
    const marks = [];
    this.data.stages.forEach((stage, at) => {
      const who = this.data.stages.length > 1 ? `${this.data.runs[at].label}: ` : '';
      for (const [time, kind, spring, ant] of stage.events) {
        marks.push({ time, kind, text: `${who}${kind} of spring ${spring}${ant === null ? '' : ` by ant ${ant}`}` });
      }
    });
    for (const run of this.data.runs) {
      for (const [time, kind, words] of run.transitions) marks.push({ time, kind, text: `${run.label}: ${words}` });
    }
    return marks.sort((a, b) => a.time - b.time);
  }

  build() {
    const names = this.data.runs.map((run) => run.label).join(', ');
    this.canvas = element('canvas', { role: 'img', tabindex: '0', 'aria-label': `Drawing of the load on ${names}; its time stands below` });
    this.listenToPointer();
    this.strip = element('canvas', { 'aria-hidden': 'true', title: 'Grasps, releases and what the load did: click to go there' });
    this.strip.addEventListener('click', (event) => {
      const box = this.strip.getBoundingClientRect();
      this.goTo(this.start + (this.end - this.start) * (event.clientX - box.left) / box.width);
    });
    this.scrub = element('input', { type: 'range', min: this.start, max: this.end, step: 'any', 'aria-label': 'Time (s)' });
    this.scrub.addEventListener('input', () => this.goTo(Number(this.scrub.value)));
    this.said = element('div', { class: 'said' });
    this.signs = element('div', { class: 'key' }, ...this.key(), this.keys);
    const stage = this.figure.querySelector('.stage');
    const track = element('div', { class: 'track' }, this.strip, this.scrub);
    const [ofTime, ofView] = [this.timeControls(), this.viewControls()].map((controls) => element('div', { class: 'controls' }, ...controls));
    stage.replaceChildren(this.canvas, track, ofTime, ofView, this.said, this.signs);
    this.figure.addEventListener('keydown', (event) => this.onKey(event));
  }

  timeControls() {
    this.playButton = button('Play', 'Space', () => this.toggle(), 'play');
    this.clock = element('span', { class: 'time' });
    return [this.playButton, this.clock,
      button('◂', 'One instant back (left arrow)', () => this.step(-1)), button('▸', 'One instant on (right arrow)', () => this.step(1)),
      button('◂ event', 'The event before ([)', () => this.toMark(-1)), button('event ▸', 'The next event (])', () => this.toMark(1)),
      this.choice('speed', SPEEDS.map((speed) => [speed, `${speed}×`]), this.speed, (speed) => { this.speed = speed; }),
      this.toggleButton('Loop', 'Begin again at the end', 'loops')];
  }

  onKey(event) {
    const isControl = /^(BUTTON|SELECT|SUMMARY)$/.test(event.target.tagName);
    const pan = 0.1 * this.grid.height;
    const acts = {
      ' ': () => this.toggle(),
      ArrowLeft: () => (event.shiftKey ? this.goTo(this.time - 1) : this.step(-1)),
      ArrowRight: () => (event.shiftKey ? this.goTo(this.time + 1) : this.step(1)),
      Home: () => this.goTo(this.start),
      End: () => this.goTo(this.end),
      '[': () => this.toMark(-1),
      ']': () => this.toMark(1),
      '+': () => this.zoomBy(ZOOM.step),
      '-': () => this.zoomBy(1 / ZOOM.step),
      0: () => { this.resetView(); this.draw(); },
      w: () => this.panBy(0, pan), s: () => this.panBy(0, -pan), a: () => this.panBy(pan, 0), d: () => this.panBy(-pan, 0),
    };
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    if (isControl && (event.key === ' ' || event.target.tagName === 'SELECT')) return;
    event.preventDefault();
    acts[event.key]();
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.time >= this.end) this.time = this.start;
    this.playButton.textContent = this.playing ? 'Pause' : 'Play';
    this.before = undefined;
    if (this.playing) requestAnimationFrame((now) => this.tick(now));
    else this.recorder?.stop();
  }

  tick(now) {
    if (!this.playing) return;
    // A page that slept does not leap.
    const passed = this.before === undefined ? 0 : Math.min((now - this.before) / 1000, 0.1);
    this.before = now;
    this.time += this.speed * passed;
    if (this.time >= this.end) {
      const goesOn = this.loops && !this.recorder && this.end > this.start;
      this.time = goesOn ? this.start : this.end;
      if (!goesOn) this.toggle();
    }
    this.draw();
    if (this.playing) requestAnimationFrame((then) => this.tick(then));
  }

  // Plays from the start to the end, or until it is stopped, and saves what is drawn.
  record() {
    if (this.playing) this.toggle();
    if (this.videoButton.ariaPressed === 'true') return;
    this.startVideo('replay');
    this.time = this.start;
    this.toggle();
  }

  resized(width) {
    sized(this.strip, this.strip.clientWidth || width, 18);
    this.markLayer = undefined;
  }

  goTo(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.draw();
  }

  // To the next kept instant of the first run, or the one before.
  step(by) {
    const times = this.data.runs[0].times;
    const at = indexAt(times, this.time);
    const isBetween = by < 0 && this.time > times[at];
    this.goTo(times[Math.min(Math.max(isBetween ? at : at + by, 0), times.length - 1)]);
  }

  toMark(by) {
    const found = by > 0 ? this.marks.find((mark) => mark.time > this.time + 1e-9) : this.marks.findLast((mark) => mark.time < this.time - 1e-9);
    this.goTo(found ? found.time : by > 0 ? this.end : this.start);
  }

  draw() {
    const states = this.data.runs.map((run) => this.stateOf(run));
    this.drawAll(this.canvas, states);
    this.drawStrip();
    this.tell(states);
    for (const follow of this.followers) follow(this.time);
  }

  drawStrip() {
    const pen = this.strip.getContext('2d');
    const width = this.strip.clientWidth || 300;
    const at = (time) => width * (time - this.start) / (this.end - this.start || 1);
    // There may be thousands of marks, and they stay where they are.
    if (!this.markLayer) this.markLayer = this.drawMarks(at, width);
    pen.drawImage(this.markLayer, 0, 0, width, 18);
    pen.fillStyle = this.look.ink;
    pen.fillRect(at(this.time) - 1, 0, 2, 18);
  }

  drawMarks(at, width) {
    const layer = element('canvas', {});
    const pen = sized(layer, width, 18);
    pen.fillStyle = this.look.back;
    pen.fillRect(0, 0, width, 18);
    const colors = { grasp: '#0072b2', release: '#d55e00', jump: '#cc79a7', touch: '#7b3fa0', impact: '#cc3311' };
    for (const kind of REMARKABLE) {
      pen.fillStyle = colors[kind] || this.look.soft;
      pen.globalAlpha = kind === 'grasp' || kind === 'release' ? 0.75 : 0.4;
      // Grasps reach up, releases down, the rest is between.
      const [top, height] = kind === 'grasp' ? [2, 7] : kind === 'release' ? [9, 7] : [4, 10];
      for (const mark of this.marks) if (mark.kind === kind) pen.fillRect(at(mark.time) - 0.5, top, 1, height);
    }
    return layer;
  }

  // The time, what happened last, and for programs the poses as computed and as drawn.
  tell(states) {
    this.scrub.value = this.time;
    const time = `${this.time.toFixed(3)} s`;
    this.clock.textContent = `${time} of ${this.end.toFixed(2)} s`;
    const last = this.marks.findLast((mark) => mark.time <= this.time + 1e-9);
    const said = last ? `Last event: ${last.text} at ${last.time.toFixed(3)} s` : 'Nothing has happened yet';
    if (this.said.textContent !== said) this.said.textContent = said;
    this.scrub.setAttribute('aria-valuetext', time);
    const data = this.canvas.dataset;
    const named = (all, of) => JSON.stringify(Object.fromEntries(all.map((state) => [state.run.label, of(state)])));
    const pose = ({ x, y, heading }) => [x, y, heading];
    data.time = this.time;
    data.zoom = this.zoom;
    data.middle = JSON.stringify(this.shift);
    data.poses = named(states, pose);
    data.drawn = named(states.map((state) => this.magnified(state, states[this.base])), pose);
    data.contacts = named(states, ({ contacts }) => contacts.filter(([x]) => !Number.isNaN(x)).map(([x, y]) => [x, y]));
  }
}
