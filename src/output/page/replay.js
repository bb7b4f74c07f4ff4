// Replays of recorded runs: each figure.replay on the page gets a stage with one view a run, or one for all, and controls.
'use strict';
(() => {
  const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100];
  const REMARKABLE = ['grasp', 'release', 'slip_onset', 'stop', 'pinning', 'unpinning', 'jump', 'touch', 'separation', 'side_stick', 'side_slip', 'impact'];
  const NO_VALUE = { 16: -32768, 32: -2147483648 };
  // Springs from slack to the largest pull: light to dark on paper, dark to light on a dark page.
  const RAMP = [[86, 180, 233], [0, 158, 115], [230, 159, 0], [213, 94, 0], [160, 20, 70]];

  // Series of numbers out of fixed point; NaN stands for no value.
  function unpack(packed) {
    const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    const size = packed.bits / 8;
    const values = new Float64Array(bytes.length / size);
    for (let i = 0; i < values.length; i++) {
      const whole = packed.bits === 16 ? view.getInt16(2 * i, true) : view.getInt32(4 * i, true);
      values[i] = whole === NO_VALUE[packed.bits] ? NaN : packed.zero + packed.step * whole;
    }
    return values;
  }

  function read(data) {
    const all = (packed) => (Array.isArray(packed) ? packed.map(all) : unpack(packed));
    for (const stage of data.stages) for (const name of ['times', 'tips', 'ants']) stage[name] = all(stage[name]);
    for (const run of data.runs) {
      for (const name of ['times', 'x', 'y', 'heading', 'vx', 'vy', 'turn_rate', 'pulls', 'contacts']) run[name] = all(run[name]);
    }
    return data;
  }

  // Number of the last instant at or before a time.
  function indexAt(times, time) {
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  // Where a time lies: an instant, the next one, and the share of the way between.
  function placeIn(times, time) {
    const from = indexAt(times, time);
    const to = Math.min(from + 1, times.length - 1);
    const span = times[to] - times[from];
    return { from, to, share: span > 0 ? Math.min(Math.max((time - times[from]) / span, 0), 1) : 0 };
  }

  // Straight between two instants; from the first alone where the second has no value.
  function between(series, place) {
    const [a, b] = [series[place.from], series[place.to]];
    return Number.isNaN(b) ? a : a + place.share * (b - a);
  }

  function turned(x, y, angle) {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [c * x - s * y, s * x + c * y];
  }

  function withPrefix(value, unit) {
    if (value === 0) return `0 ${unit}`;
    for (const [factor, prefix] of [[1, ''], [1e3, 'm'], [1e6, 'µ'], [1e9, 'n']]) {
      if (Math.abs(value) * factor >= 0.9995) return `${(value * factor).toPrecision(4)} ${prefix}${unit}`;
    }
    return `${value.toExponential(2)} ${unit}`;
  }

  function rampColor(share) {
    const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1);
    const [a, b] = [RAMP[Math.floor(at)], RAMP[Math.min(Math.floor(at) + 1, RAMP.length - 1)]];
    return `rgb(${a.map((part, i) => Math.round(part + (at % 1) * (b[i] - part))).join(',')})`;
  }

  function element(name, attributes, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }

  // Colours of the figures, which stand on white, for a dark page.
  const LIGHTER = { '#0072B2': '#4aa8e8', '#D55E00': '#ff8d45', '#000000': '#f0f0f0' };

  class Player {
    constructor(figure, data) {
      this.figure = figure;
      this.data = data;
      this.end = Math.max(...data.runs.map((run) => run.times[run.times.length - 1]));
      this.start = Math.min(...data.runs.map((run) => run.times[0]));
      this.time = Math.min(Math.max(data.opens_at, this.start), this.end);
      const wish = (this.end - this.start) / 20;
      this.speed = SPEEDS.reduce((best, speed) => (Math.abs(Math.log(speed / wish)) < Math.abs(Math.log(best / wish)) ? speed : best), 1);
      this.isOverlaid = false;
      this.follows = true;
      this.loops = true;
      this.playing = false;
      this.marks = this.collectMarks();
      this.whole = this.extentOfAll();
      this.reach = this.reachOfSprings();
      this.build();
      new ResizeObserver(() => this.resize()).observe(this.canvas);
      matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
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

    extentOfAll() {
      const box = [Infinity, Infinity, -Infinity, -Infinity];
      const add = (x, y, r) => {
        if (Number.isNaN(x + y)) return;
        box[0] = Math.min(box[0], x - r); box[1] = Math.min(box[1], y - r);
        box[2] = Math.max(box[2], x + r); box[3] = Math.max(box[3], y + r);
      };
      for (const run of this.data.runs) run.x.forEach((x, i) => add(x, run.y[i], 1.3 * this.data.radius));
      for (const stage of this.data.stages) for (const [x, y] of stage.tips) x.forEach((value, i) => add(value, y[i], 0));
      if (this.data.nest) add(...this.data.nest);
      for (const { path } of this.data.obstacles) if (path.length > 1) for (const [, x, y] of path) add(x, y, 0.5 * this.data.radius);
      return box;
    }

    // How far around a load that is followed the view goes.
    reachOfSprings() {
      let reach = 2.2 * this.data.radius;
      for (const [, ends] of this.data.springs) reach = Math.max(reach, Math.hypot(ends[2], ends[3]));
      return 1.7 * reach;
    }

    build() {
      const button = (text, title, act, name = '') => {
        const made = element('button', { type: 'button', title, class: name }, text);
        made.addEventListener('click', act);
        return made;
      };
      const toggle = (text, title, key) => {
        const made = button(text, title, () => { this[key] = !this[key]; made.setAttribute('aria-pressed', this[key]); this.resize(); });
        made.setAttribute('aria-pressed', this[key]);
        return made;
      };
      const names = this.data.runs.map((run) => run.label).join(', ');
      this.canvas = element('canvas', { role: 'img', tabindex: '0', 'aria-label': `Drawing of the load on ${names}; its time is told below` });
      this.strip = element('canvas', { 'aria-hidden': 'true', title: 'Grasps, releases and what the load did: click to go there' });
      this.strip.addEventListener('click', (event) => {
        const box = this.strip.getBoundingClientRect();
        this.goTo(this.start + (this.end - this.start) * (event.clientX - box.left) / box.width);
      });
      this.scrub = element('input', { type: 'range', min: this.start, max: this.end, step: 'any', 'aria-label': 'Time (s)' });
      this.scrub.addEventListener('input', () => this.goTo(Number(this.scrub.value)));
      this.playButton = button('Play', 'Space', () => this.toggle(), 'play');
      this.clock = element('span', { class: 'time' });
      this.said = element('div', { class: 'said' });
      const speed = element('select', { 'aria-label': 'Speed' }, ...SPEEDS.map((value) => element('option', { value }, `${value}×`)));
      speed.value = this.speed;
      speed.addEventListener('change', () => { this.speed = Number(speed.value); });
      const controls = [this.playButton, this.clock,
        button('◂', 'One instant back (left arrow)', () => this.step(-1)), button('▸', 'One instant on (right arrow)', () => this.step(1)),
        button('◂ event', 'The event before ([)', () => this.toMark(-1)), button('event ▸', 'The next event (])', () => this.toMark(1)),
        element('label', {}, 'speed ', speed), toggle('Loop', 'Begin again at the end', 'loops'), toggle('Follow the load', 'Or show the whole way', 'follows')];
      if (this.data.runs.length > 1) controls.push(toggle('Overlay', 'All runs in one view', 'isOverlaid'));
      const stage = this.figure.querySelector('.stage');
      stage.replaceChildren(this.canvas, element('div', { class: 'track' }, this.strip, this.scrub), element('div', { class: 'controls' }, ...controls), this.said, this.key());
      this.figure.addEventListener('keydown', (event) => this.onKey(event));
    }

    // What the signs mean.
    key() {
      const sign = (svg, text) => {
        const made = element('span', {});
        made.innerHTML = svg;
        made.append(text);
        return made;
      };
      const drawn = (content) => `<svg viewBox="0 0 26 16" aria-hidden="true">${content}</svg>`;
      const signs = [];
      if (this.data.supports.some((support) => support[2] > 0)) {
        signs.push(sign(drawn('<rect x="8" y="3" width="10" height="10" fill="#777"/>'), 'sticking support'));
        signs.push(sign(drawn('<circle cx="7" cy="8" r="4.5" fill="#e69f00"/><path d="M7 8H23M18 4l5 4-5 4" stroke="#009e73" stroke-width="2" fill="none"/>'), 'slipping support, slip velocity'));
        signs.push(sign(drawn('<path d="M23 8H3" stroke="#cc3311" stroke-width="3"/><path d="M9 3L2 8l7 5z" fill="#cc3311"/>'), 'friction on the load'));
      }
      if (this.data.springs.length) {
        const canvas = element('canvas', { class: 'ramp', width: 90, height: 10, 'aria-hidden': 'true' });
        const pen = canvas.getContext('2d');
        for (let x = 0; x < 90; x++) { pen.fillStyle = rampColor(x / 89); pen.fillRect(x, 0, 1, 10); }
        signs.push(element('span', {}, 'pull on a spring 0', canvas, withPrefix(this.data.largest_pull, 'N')));
      }
      if (this.data.obstacles.length) {
        signs.push(sign(drawn('<path d="M3 13V3H23V13Z" fill="none" stroke="#777" stroke-width="1.5"/><path d="M3 9l6-6M4 13L14 3M9 13L19 3M14 13l9-9M19 13l4-4" stroke="#999" stroke-width="0.8"/>'), 'obstacle'));
        if (this.data.force_unit > 0) signs.push(sign(drawn('<path d="M6 8H23" stroke="#7b3fa0" stroke-width="2.5"/><path d="M17 3l7 5-7 5z" fill="#7b3fa0"/><circle cx="5" cy="8" r="3.5" fill="#7b3fa0"/>'), 'contact, force of an obstacle on the load'));
      }
      if (this.data.has_ants) {
        signs.push(sign(drawn('<ellipse cx="8" cy="8" rx="5" ry="3.4" fill="#a04000"/><circle cx="17" cy="8" r="2.6" fill="#a04000"/>'), 'ant that pulls'));
        signs.push(sign(drawn('<ellipse cx="8" cy="8" rx="5" ry="3.4" fill="none" stroke="#888"/><circle cx="17" cy="8" r="2.6" fill="none" stroke="#888"/>'), 'ant that searches'));
      }
      if (this.data.runs.length > 1) signs.push(sign(drawn('<circle cx="13" cy="8" r="6.5" fill="none" stroke="#888" stroke-dasharray="3 2"/>'), `where ${this.data.runs[0].label} is`));
      signs.push('Keys: space, ← → an instant, shift a second, [ ] events');
      return element('div', { class: 'key' }, ...signs);
    }

    onKey(event) {
      const isControl = /^(BUTTON|SELECT|SUMMARY)$/.test(event.target.tagName);
      const seconds = event.shiftKey ? 1 : 0;
      const acts = {
        ' ': () => this.toggle(),
        ArrowLeft: () => (seconds ? this.goTo(this.time - 1) : this.step(-1)),
        ArrowRight: () => (seconds ? this.goTo(this.time + 1) : this.step(1)),
        Home: () => this.goTo(this.start),
        End: () => this.goTo(this.end),
        '[': () => this.toMark(-1),
        ']': () => this.toMark(1),
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
    }

    tick(now) {
      if (!this.playing) return;
      // A page that slept does not leap.
      const passed = this.before === undefined ? 0 : Math.min((now - this.before) / 1000, 0.1);
      this.before = now;
      this.time += this.speed * passed;
      if (this.time >= this.end) {
        this.time = this.loops && this.end > this.start ? this.start : this.end;
        if (!this.loops) this.toggle();
      }
      this.draw();
      if (this.playing) requestAnimationFrame((then) => this.tick(then));
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

    resize() {
      const width = this.canvas.clientWidth || 300;
      const count = this.isOverlaid ? 1 : this.data.runs.length;
      const columns = width < 640 ? 1 : count;
      const rows = Math.ceil(count / columns);
      const height = Math.round(Math.min(Math.max(width / columns, 180), columns === 1 && rows > 1 ? 260 : 420));
      this.grid = { columns, width: width / columns, height };
      this.sized(this.canvas, width, rows * height);
      this.sized(this.strip, this.strip.clientWidth || width, 18);
      this.markLayer = undefined;
      this.draw();
    }

    sized(canvas, width, height) {
      const density = window.devicePixelRatio || 1;
      canvas.width = Math.round(width * density);
      canvas.height = Math.round(height * density);
      canvas.style.height = `${height}px`;
      canvas.getContext('2d').setTransform(density, 0, 0, density, 0, 0);
    }

    draw() {
      const dark = matchMedia('(prefers-color-scheme: dark)').matches;
      this.look = dark ? { back: '#1e2125', ink: '#e8e8e4', soft: '#9aa0a8', faint: '#3d4249' } : { back: '#ffffff', ink: '#1c1d1f', soft: '#777d85', faint: '#dcdcd8' };
      if (this.dark !== dark) this.markLayer = undefined;
      this.dark = dark;
      const states = this.data.runs.map((run) => this.stateOf(run));
      const pen = this.canvas.getContext('2d');
      const { columns, width, height } = this.grid;
      pen.fillStyle = this.look.back;
      pen.fillRect(0, 0, this.canvas.width, this.canvas.height);
      const views = this.isOverlaid ? [states] : states.map((state) => [state]);
      views.forEach((shown, at) => {
        pen.save();
        pen.translate((at % columns) * width, Math.floor(at / columns) * height);
        pen.beginPath();
        pen.rect(0, 0, width, height);
        pen.clip();
        this.drawView(pen, shown, states, width, height);
        pen.restore();
      });
      this.drawStrip();
      this.tell(states);
    }

    // Pose, speed, tips and ants of a run now.
    stateOf(run) {
      const place = placeIn(run.times, this.time);
      const stage = this.data.stages[run.stage];
      const staged = placeIn(stage.times, this.time);
      const tips = stage.tips.map(([x, y]) => [between(x, staged), between(y, staged)]);
      const ants = stage.ants.map(([x, y, heading]) => {
        const [from, to] = [heading[staged.from], heading[staged.to]];
        const turn = Math.atan2(Math.sin(to - from), Math.cos(to - from));
        return { x: between(x, staged), y: between(y, staged), heading: from + staged.share * turn, holds: from > 3 * Math.PI };
      });
      return {
        run, tips, ants,
        x: between(run.x, place), y: between(run.y, place), heading: between(run.heading, place),
        // What moves is told by the instant before, as tips hold or not.
        vx: run.vx[place.from], vy: run.vy[place.from], rate: run.turn_rate[place.from],
        pulls: run.pulls.map((series) => between(series, place)),
        contacts: run.contacts.map((series) => series.map((values) => between(values, place))),
        place,
      };
    }

    // Distance of the rim from the first run's: shift and radius times turn.
    apart(state, first) {
      return Math.hypot(state.x - first.x, state.y - first.y) + this.data.radius * Math.abs(state.heading - first.heading);
    }

    colorOf(run) {
      return (this.dark && LIGHTER[run.color]) || run.color;
    }

    drawView(pen, shown, states, width, height) {
      const first = states[0];
      // Loads at the same tips stay together; others are followed one by one.
      const scale = this.scaleOf(this.data.stages.length > 1 ? shown[0] : first, width, height);
      this.drawScene(pen, scale, width, height);
      this.drawObstacles(pen, scale);
      // Below all else, as it may not hide springs or ants.
      if (this.follows) this.drawMap(pen, shown, width, height);
      for (const state of shown) this.drawTrail(pen, state, scale, this.follows ? 0.35 : 0.6);
      const top = shown[shown.length - 1];
      this.drawFree(pen, top, scale);
      if (!this.isOverlaid && top !== first) this.drawOutline(pen, first, scale, this.look.soft, [4, 3]);
      for (const state of shown) {
        this.drawLoad(pen, state, scale);
        this.drawHeld(pen, state, scale);
        if (!this.isOverlaid) this.drawSupports(pen, state, scale);
        this.drawContacts(pen, state, scale);
      }
      const isShared = this.data.stages.length === 1;
      if (isShared) this.drawAnts(pen, top, scale); else for (const state of shown) this.drawAnts(pen, state, scale, this.isOverlaid && this.colorOf(state.run));
      this.drawScaleBar(pen, scale, width, height);
      this.drawTitle(pen, shown, first, width);
      pen.strokeStyle = this.look.faint;
      pen.strokeRect(0.5, 0.5, width - 1, height - 1);
    }

    // World to view: equal along both axes, y upwards.
    scaleOf(followed, width, height) {
      const fit = (box) => {
        const per = Math.min((width - 24) / (box[2] - box[0]), (height - 64) / (box[3] - box[1])) || 1;
        const [x, y] = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
        return { per, to: (wx, wy) => [width / 2 + per * (wx - x), height / 2 + 12 - per * (wy - y)] };
      };
      if (!this.follows) return fit(this.whole);
      return fit([followed.x - this.reach, followed.y - this.reach, followed.x + this.reach, followed.y + this.reach]);
    }

    drawScene(pen, scale) {
      if (!this.data.nest) return;
      const [x, y, radius] = this.data.nest;
      const [px, py] = scale.to(x, y);
      pen.strokeStyle = '#009e73';
      pen.fillStyle = '#009e7322';
      pen.lineWidth = 1.5;
      pen.setLineDash([4, 3]);
      pen.beginPath();
      pen.arc(px, py, Math.max(radius * scale.per, 4), 0, 2 * Math.PI);
      pen.fill();
      pen.stroke();
      pen.setLineDash([]);
      this.text(pen, 'nest', px, py - Math.max(radius * scale.per, 4) - 5, 'center', this.dark ? '#5fd0a8' : '#00754f');
    }

    drawTrail(pen, state, scale, strength) {
      const { run, place } = state;
      const path = (from, to) => {
        pen.beginPath();
        for (let i = from; i <= to; i++) {
          const [x, y] = scale.to(run.x[i], run.y[i]);
          if (i === from) pen.moveTo(x, y); else pen.lineTo(x, y);
        }
        pen.stroke();
      };
      pen.lineJoin = 'round';
      pen.strokeStyle = this.look.faint;
      pen.lineWidth = 1;
      path(place.from, run.times.length - 1);
      pen.strokeStyle = this.colorOf(run);
      pen.globalAlpha = strength;
      pen.lineWidth = 1.8;
      path(0, place.from);
      pen.globalAlpha = 1;
    }

    // Adds the parts of an outline at a pose to the path of the pen.
    trace(pen, outline, pose, scale) {
      for (const part of outline) {
        if (part.disc) {
          const [x, y] = scale.to(...this.placed(pose, part.disc[0], part.disc[1]));
          const radius = part.disc[2] * scale.per;
          pen.moveTo(x + radius, y);
          pen.arc(x, y, radius, 0, 2 * Math.PI);
          continue;
        }
        (part.polygon || part.polyline).forEach(([px, py], i) => {
          const [x, y] = scale.to(...this.placed(pose, px, py));
          if (i === 0) pen.moveTo(x, y); else pen.lineTo(x, y);
        });
        if (part.polygon) pen.closePath();
      }
    }

    // Pose of an obstacle now.
    poseOf(obstacle) {
      const { path } = obstacle;
      const { from, to, share } = placeIn(path.map((waypoint) => waypoint[0]), this.time);
      const [x, y, heading] = [1, 2, 3].map((i) => path[from][i] + share * (path[to][i] - path[from][i]));
      return { x, y, heading };
    }

    // Obstacles that stand still are hatched, those that move are grey, with their path.
    drawObstacles(pen, scale) {
      for (const obstacle of this.data.obstacles) {
        const pose = this.poseOf(obstacle);
        if (obstacle.path.length > 1) {
          pen.strokeStyle = this.look.soft;
          pen.lineWidth = 1;
          pen.setLineDash([2, 3]);
          pen.beginPath();
          obstacle.path.forEach(([, x, y], i) => (i ? pen.lineTo(...scale.to(x, y)) : pen.moveTo(...scale.to(x, y))));
          pen.stroke();
          pen.setLineDash([]);
        }
        const closed = obstacle.outline.filter((part) => !part.polyline);
        pen.beginPath();
        this.trace(pen, closed, pose, scale);
        pen.fillStyle = obstacle.path.length > 1 ? this.look.faint : this.hatching(pen);
        pen.fill('nonzero');
        pen.beginPath();
        this.trace(pen, obstacle.outline, pose, scale);
        pen.strokeStyle = this.look.soft;
        pen.lineWidth = 1.8;
        pen.stroke();
      }
    }

    // Lines of 45 degrees as a pattern.
    hatching(pen) {
      const size = 8;
      const tile = element('canvas', { width: size, height: size });
      const inner = tile.getContext('2d');
      inner.strokeStyle = this.look.soft;
      inner.lineWidth = 0.7;
      inner.beginPath();
      for (const shift of [-size, 0, size]) { inner.moveTo(shift - 1, size + 1); inner.lineTo(shift + size + 1, -1); }
      inner.stroke();
      return pen.createPattern(tile, 'repeat');
    }

    // A dot where the load touches, and an arrow of the force on the load.
    drawContacts(pen, state, scale) {
      const unit = this.data.radius * scale.per;
      const color = this.dark ? '#c79ae0' : '#7b3fa0';
      for (const [px, py, fx, fy] of state.contacts) {
        if (Number.isNaN(px)) continue;
        const [x, y] = scale.to(px, py);
        const force = Math.hypot(fx, fy);
        const share = force / (this.data.force_unit || 1);
        if (share * unit > 3) this.arrow(pen, x, y, fx / force, -fy / force, unit * Math.min(share, 1), color, 2.5, share > 1.001);
        pen.fillStyle = color;
        pen.beginPath();
        pen.arc(x, y, 4, 0, 2 * Math.PI);
        pen.fill();
      }
    }

    drawOutline(pen, state, scale, color, dash) {
      const [x, y] = scale.to(state.x, state.y);
      const front = this.data.front * scale.per;
      pen.strokeStyle = color;
      pen.lineWidth = 1.5;
      pen.setLineDash(dash);
      pen.beginPath();
      this.trace(pen, this.data.outline, state, scale);
      pen.moveTo(x, y);
      pen.lineTo(x + front * Math.cos(state.heading), y - front * Math.sin(state.heading));
      pen.stroke();
      pen.setLineDash([]);
    }

    drawLoad(pen, state, scale) {
      pen.fillStyle = this.colorOf(state.run);
      pen.globalAlpha = 0.14;
      pen.beginPath();
      this.trace(pen, this.data.outline, state, scale);
      pen.fill();
      pen.globalAlpha = 1;
      this.drawOutline(pen, state, scale, this.colorOf(state.run), []);
    }

    placed(state, x, y) {
      const [dx, dy] = turned(x, y, state.heading);
      return [state.x + dx, state.y + dy];
    }

    // Springs that nobody holds, at rest in the load's frame.
    drawFree(pen, state, scale) {
      pen.strokeStyle = this.look.soft;
      pen.globalAlpha = 0.55;
      pen.lineWidth = 1.2;
      pen.beginPath();
      this.data.springs.forEach(([, ends], i) => {
        if (!Number.isNaN(state.tips[i][0])) return;
        pen.moveTo(...scale.to(...this.placed(state, ends[0], ends[1])));
        pen.lineTo(...scale.to(...this.placed(state, ends[2], ends[3])));
      });
      pen.stroke();
      pen.globalAlpha = 1;
    }

    drawHeld(pen, state, scale) {
      pen.lineWidth = Math.min(Math.max(0.12 * this.data.radius * scale.per, 2), 5);
      this.data.springs.forEach(([, ends], i) => {
        const [tx, ty] = state.tips[i];
        if (Number.isNaN(tx)) return;
        const pull = state.pulls[i];
        pen.strokeStyle = pen.fillStyle = Number.isNaN(pull) ? this.look.soft : rampColor(pull / (this.data.largest_pull || 1));
        const [x, y] = scale.to(tx, ty);
        pen.beginPath();
        pen.moveTo(...scale.to(...this.placed(state, ends[0], ends[1])));
        pen.lineTo(x, y);
        pen.stroke();
        pen.beginPath();
        pen.arc(x, y, pen.lineWidth, 0, 2 * Math.PI);
        pen.fill();
      });
    }

    // Slip of each support by the load's twist; friction is mu N against it, Eq. (13), and not known where it sticks.
    drawSupports(pen, state, scale) {
      const size = Math.min(Math.max(0.09 * this.data.radius * scale.per, 2), 6);
      const largest = Math.max(...this.data.supports.map((support) => support[2]));
      for (const [ox, oy, limit] of this.data.supports) {
        if (!(limit > 0)) continue;
        const [ax, ay] = turned(ox, oy, state.heading);
        const [x, y] = scale.to(state.x + ax, state.y + ay);
        const [sx, sy] = [state.vx - state.rate * ay, state.vy + state.rate * ax];
        const speed = Math.hypot(sx, sy);
        if (!(speed > state.run.sticks_below)) {
          pen.fillStyle = this.look.soft;
          pen.fillRect(x - size, y - size, 2 * size, 2 * size);
          continue;
        }
        const [ux, uy] = [sx / speed, -sy / speed];
        const share = speed / (this.data.slip_unit || speed);
        const unit = this.data.radius * scale.per;
        this.arrow(pen, x, y, ux, uy, unit * Math.min(share, 1), '#009e73', 2, share > 1);
        this.arrow(pen, x, y, -ux, -uy, 0.8 * unit * limit / largest, '#cc3311', 3, false);
        pen.fillStyle = '#e69f00';
        pen.beginPath();
        pen.arc(x, y, size, 0, 2 * Math.PI);
        pen.fill();
      }
    }

    arrow(pen, x, y, ux, uy, length, color, width, isCut) {
      const head = Math.min(8, 0.6 * length);
      const [ex, ey] = [x + ux * length, y + uy * length];
      pen.strokeStyle = pen.fillStyle = color;
      pen.lineWidth = width;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(ex - ux * head, ey - uy * head);
      pen.stroke();
      for (const back of isCut ? [0, 1.1 * head] : [0]) {
        const [hx, hy] = [ex - ux * back, ey - uy * back];
        pen.beginPath();
        pen.moveTo(hx, hy);
        pen.lineTo(hx - ux * head - 0.5 * uy * head, hy - uy * head + 0.5 * ux * head);
        pen.lineTo(hx - ux * head + 0.5 * uy * head, hy - uy * head - 0.5 * ux * head);
        pen.fill();
      }
    }

    // The mandibles are where the ant is; its body lies behind them.
    drawAnts(pen, state, scale, color) {
      const length = Math.max(0.75 * this.data.radius * scale.per, 9);
      for (const ant of state.ants) {
        const [x, y] = scale.to(ant.x, ant.y);
        pen.save();
        pen.translate(x, y);
        pen.rotate(-ant.heading);
        pen.strokeStyle = pen.fillStyle = color || (ant.holds ? (this.dark ? '#e08a50' : '#8a3800') : this.look.soft);
        pen.lineWidth = 1.2;
        for (const [at, along, across] of [[-0.2, 0.15, 0.12], [-0.48, 0.15, 0.09], [-0.82, 0.22, 0.16]]) {
          pen.beginPath();
          pen.ellipse(at * length, 0, along * length, across * length, 0, 0, 2 * Math.PI);
          if (ant.holds) pen.fill(); else pen.stroke();
        }
        pen.beginPath();
        for (const side of [-1, 1]) {
          pen.moveTo(-0.08 * length, side * 0.05 * length);
          pen.lineTo(0, side * 0.02 * length);
          for (const leg of [-0.38, -0.48, -0.58]) {
            pen.moveTo(leg * length, side * 0.08 * length);
            pen.lineTo((leg + 0.9 * (leg + 0.48)) * length, side * 0.32 * length);
          }
        }
        pen.stroke();
        pen.restore();
      }
      if (this.data.has_ants) return;
      pen.strokeStyle = this.look.ink;
      pen.lineWidth = 1.2;
      for (const [x, y] of state.tips) {
        if (Number.isNaN(x)) continue;
        pen.beginPath();
        pen.arc(...scale.to(x, y), 6, 0, 2 * Math.PI);
        pen.stroke();
      }
    }

    // The whole way, small, in a corner.
    drawMap(pen, shown, width, height) {
      const side = Math.min(96, 0.28 * width);
      const [left, top] = [width - side - 8, height - side - 8];
      const box = this.whole;
      const per = (side - 10) / Math.max(box[2] - box[0], box[3] - box[1]) || 1;
      const to = (x, y) => [left + side / 2 + per * (x - (box[0] + box[2]) / 2), top + side / 2 - per * (y - (box[1] + box[3]) / 2)];
      pen.fillStyle = this.look.back;
      pen.fillRect(left, top, side, side);
      pen.lineWidth = 1;
      pen.strokeStyle = this.look.faint;
      pen.strokeRect(left + 0.5, top + 0.5, side - 1, side - 1);
      if (this.data.obstacles.length) {
        pen.save();
        pen.beginPath();
        pen.rect(left, top, side, side);
        pen.clip();
        pen.strokeStyle = this.look.soft;
        for (const obstacle of this.data.obstacles) {
          pen.beginPath();
          this.trace(pen, obstacle.outline, this.poseOf(obstacle), { per, to });
          pen.stroke();
        }
        pen.restore();
      }
      if (this.data.nest) {
        pen.strokeStyle = '#009e73';
        pen.beginPath();
        pen.arc(...to(this.data.nest[0], this.data.nest[1]), Math.max(per * this.data.nest[2], 2), 0, 2 * Math.PI);
        pen.stroke();
      }
      for (const { run, x, y } of shown) {
        pen.strokeStyle = this.look.soft;
        pen.beginPath();
        const every = Math.max(1, Math.floor(run.times.length / 600));
        for (let i = 0; i < run.times.length; i += every) pen.lineTo(...to(run.x[i], run.y[i]));
        pen.stroke();
        pen.fillStyle = this.colorOf(run);
        pen.beginPath();
        pen.arc(...to(x, y), 3, 0, 2 * Math.PI);
        pen.fill();
      }
    }

    // A length that is one, two or five of a power of ten.
    drawScaleBar(pen, scale, width, height) {
      const wish = 0.22 * width / scale.per;
      const power = 10 ** Math.floor(Math.log10(wish));
      const length = power * (wish / power >= 5 ? 5 : wish / power >= 2 ? 2 : 1);
      const [x, y] = [12, height - 12];
      pen.strokeStyle = this.look.ink;
      pen.lineWidth = 1.5;
      pen.beginPath();
      pen.moveTo(x, y - 4); pen.lineTo(x, y); pen.lineTo(x + length * scale.per, y); pen.lineTo(x + length * scale.per, y - 4);
      pen.stroke();
      const text = withPrefix(length, 'm').replace(/\.?0+ /, ' ');
      this.text(pen, text, x, y - 8, 'left', this.look.soft);
    }

    drawTitle(pen, shown, first, width) {
      let x = 12;
      for (const { run } of shown) {
        pen.fillStyle = this.colorOf(run);
        pen.fillRect(x, 11, 12, 12);
        this.text(pen, run.label, x + 18, 22, 'left', this.look.ink, '600 14px');
        x += 18 + pen.measureText(run.label).width + 16;
      }
      const apart = shown.filter((state) => state !== first).map((state) => {
        const distance = withPrefix(this.apart(state, first), 'm');
        return this.isOverlaid ? `${state.run.label} ${distance}` : distance;
      });
      if (apart.length) this.text(pen, `rim off ${first.run.label}: ${apart.join(', ')}`, 12, 42, 'left', this.look.soft);
    }

    text(pen, text, x, y, align, color, font = '13px') {
      pen.font = `${font} system-ui, "DejaVu Sans", Verdana, sans-serif`;
      pen.textAlign = align;
      pen.fillStyle = color;
      pen.fillText(text, x, y);
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
      this.sized(layer, width, 18);
      const pen = layer.getContext('2d');
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

    // The time, what happened last, and for programs the poses as drawn.
    tell(states) {
      this.scrub.value = this.time;
      const time = `${this.time.toFixed(3)} s`;
      this.clock.textContent = `${time} of ${this.end.toFixed(2)} s`;
      const last = this.marks.findLast((mark) => mark.time <= this.time + 1e-9);
      const said = last ? `Last event: ${last.text} at ${last.time.toFixed(3)} s` : 'Nothing has happened yet';
      if (this.said.textContent !== said) this.said.textContent = said;
      this.scrub.setAttribute('aria-valuetext', time);
      this.canvas.dataset.time = this.time;
      const touched = ({ contacts }) => contacts.filter(([x]) => !Number.isNaN(x)).map(([x, y]) => [x, y]);
      this.canvas.dataset.contacts = JSON.stringify(Object.fromEntries(states.map((state) => [state.run.label, touched(state)])));
      this.canvas.dataset.poses = JSON.stringify(Object.fromEntries(states.map(({ run, x, y, heading }) => [run.label, [x, y, heading]])));
    }
  }

  document.querySelectorAll('figure.replay').forEach((figure) => {
    const data = read(JSON.parse(figure.querySelector('script').textContent));
    if (data.runs.length && data.runs[0].times.length) new Player(figure, data);
    else figure.querySelector('.stage').textContent = 'Nothing was recorded.';
  });
})();
