// Curves over time, tied to a replay: a cursor at its time, the values there or under the pointer, and files of them.

const ROOM = { left: 66, right: 12, top: 26, bottom: 36 };
const PLOT_HEIGHT = 210;
// A range below this differs by rounding alone, in any unit.
const ROUNDING = 1e-14;

// Dashes as lengths (px).
function dashes(dash) {
  return dash ? dash.split(' ').map(Number) : [];
}

function raised(exponent) {
  return `10${[...String(exponent)].map((sign) => (sign === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[sign])).join('')}`;
}

// Multiples of a step between two numbers, with the text of each.
function ticks(low, high, most) {
  const step = 1 / niceBelow(most / (high - low));
  const decimals = Math.max(0, -Math.floor(Math.log10(step * 1.0001)));
  const first = Math.ceil(low / step - 1e-9);
  const text = (value) => (decimals > 4 || Math.abs(value) >= 1e6 ? value.toExponential(1) : value.toFixed(decimals)).replace('-', '−');
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => (first + k) * step + 0).map((value) => [value, text(value)]);
}

class Plot {
  constructor(panel, number, player) {
    this.panel = panel;
    this.number = number;
    this.player = player;
    this.isLog = panel.scale === 'log';
    for (const curve of panel.curves) [curve.x, curve.y] = [unpack(curve.x), unpack(curve.y)];
    this.axes();
    const names = panel.curves.map((curve) => curve.label).join(', ');
    this.canvas = element('canvas', { role: 'img', tabindex: '0', 'aria-label': `${panel.y} over ${panel.x}: ${names}` });
    this.values = element('div', { class: 'values' });
    const files = element('span', { class: 'files' },
      button('PNG', 'Saves this plot as an image', () => this.saveImage()), button('CSV', 'Saves these curves as a table', () => this.saveTable()));
    this.box = element('div', { class: 'plot' }, this.canvas, this.values, files);
    this.listen();
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    scheme.listeners.push(() => this.resize());
  }

  // Ranges of both axes; of logarithms where the axis is logarithmic.
  axes() {
    const { curves, levels, ceiling, scale } = this.panel;
    const most = ceiling ?? Infinity;
    const [xs, ys] = [[Infinity, -Infinity], [Infinity, -Infinity]];
    const add = (range, value) => { if (Number.isFinite(value)) { range[0] = Math.min(range[0], value); range[1] = Math.max(range[1], value); } };
    for (const { x, y } of curves.flatMap((curve) => [curve, ...(curve.before ? [curve.before] : [])])) {
      x.forEach((value) => add(xs, value));
      y.forEach((value) => add(ys, Math.min(value, most)));
    }
    // Plots of one replay have one axis of time, gaps at its ends included.
    if (this.player) for (const time of [this.player.start, this.player.end]) add(xs, time);
    for (const level of levels) add(ys, this.isLog ? Math.log10(level.y) : level.y);
    if (scale === 'from_zero' || scale === 'count') add(ys, 0);
    if (!(xs[0] <= xs[1])) xs.splice(0, 2, 0, 1);
    if (!(ys[0] <= ys[1])) ys.splice(0, 2, 0, 1);
    if (xs[0] === xs[1]) xs[1] += 1;
    if (this.isLog) ys.splice(0, 2, Math.floor(ys[0]), Math.max(Math.ceil(ys[1]), Math.floor(ys[0]) + 1));
    else {
      const isRounding = ys[1] - ys[0] < ROUNDING;
      const room = isRounding ? 0.5 * Math.abs(ys[1]) * (Math.abs(ys[1]) > ROUNDING) || 1 : 0.05 * (ys[1] - ys[0]);
      const isFromZero = ys[0] === 0 && scale !== 'linear';
      ys.splice(0, 2, isFromZero ? 0 : ys[0] - room, ys[1] + room);
    }
    [this.xs, this.ys] = [xs, ys];
  }

  listen() {
    const timeAt = (event) => {
      const x = event.clientX - this.canvas.getBoundingClientRect().left;
      const share = (x - ROOM.left) / (this.width - ROOM.left - ROOM.right);
      return this.xs[0] + Math.min(Math.max(share, 0), 1) * (this.xs[1] - this.xs[0]);
    };
    this.canvas.addEventListener('pointermove', (event) => {
      this.pointed = timeAt(event);
      if (event.buttons & 1) this.player?.goTo(this.pointed);
      else this.draw();
    });
    this.canvas.addEventListener('pointerleave', () => { this.pointed = undefined; this.draw(); });
    this.canvas.addEventListener('click', (event) => this.player?.goTo(timeAt(event)));
  }

  resize() {
    this.width = this.canvas.clientWidth || 300;
    sized(this.canvas, this.width, PLOT_HEIGHT);
    this.layer = element('canvas', {});
    this.layerPen = sized(this.layer, this.width, PLOT_HEIGHT);
    this.redraw();
  }

  redraw() {
    this.drawAxes(this.layerPen, this.width);
    this.draw();
  }

  // After the curves have grown.
  refresh() {
    this.axes();
    if (this.layer) this.redraw(); else this.resize();
  }

  // Number to place on the drawing (px).
  scales(width) {
    const along = ([low, high], from, to) => (value) => from + (to - from) * (value - low) / (high - low);
    return [along(this.xs, ROOM.left, width - ROOM.right), along(this.ys, PLOT_HEIGHT - ROOM.bottom, ROOM.top)];
  }

  drawAxes(pen, width) {
    const [x, y] = this.scales(width);
    const { back, ink, soft, faint } = scheme.look;
    const [left, right, top, bottom] = [ROOM.left, width - ROOM.right, ROOM.top, PLOT_HEIGHT - ROOM.bottom];
    pen.fillStyle = back;
    pen.fillRect(0, 0, width, PLOT_HEIGHT);
    const line = (points, color, wide, dash = '') => {
      pen.strokeStyle = color;
      pen.lineWidth = wide;
      pen.setLineDash(dashes(dash));
      pen.beginPath();
      points.forEach(([px, py], i) => (i ? pen.lineTo(px, py) : pen.moveTo(px, py)));
      pen.stroke();
      pen.setLineDash([]);
    };
    const [factor, unit] = this.prefix();
    for (const [value, text] of this.upTicks(factor)) {
      line([[left, y(value)], [right, y(value)]], faint, 1);
      write(pen, text, left - 6, y(value) + 4, 'right', soft, '12px');
    }
    for (const [value, text] of ticks(this.xs[0], this.xs[1], Math.max(width / 80, 2))) {
      line([[x(value), bottom], [x(value), bottom + 4]], soft, 1);
      write(pen, text, x(value), bottom + 17, 'center', soft, '12px');
    }
    write(pen, unit ? `${this.panel.y} (${unit})` : this.panel.y, 8, 17, 'left', ink, '600 13px');
    write(pen, this.panel.x, right, PLOT_HEIGHT - 5, 'right', soft, '12px');
    if (this.panel.note) write(pen, this.panel.note, right, 17, 'right', soft, '12px');
    pen.save();
    pen.beginPath();
    pen.rect(left, top, right - left, bottom - top);
    pen.clip();
    for (const { time, color, dash } of this.panel.instants) line([[x(time), top], [x(time), bottom]], scheme.color(color), 1, dash);
    for (const { y: level, color, dash } of this.panel.levels) {
      const at = y(this.isLog ? Math.log10(level) : level);
      line([[left, at], [right, at]], scheme.color(color), 1.5, dash);
    }
    pen.globalAlpha = 0.4;
    for (const curve of this.panel.curves) if (curve.before) this.drawCurve(pen, { ...curve, ...curve.before }, x, y);
    pen.globalAlpha = 1;
    for (const curve of this.panel.curves) this.drawCurve(pen, curve, x, y);
    pen.restore();
    line([[left, top], [left, bottom], [right, bottom]], soft, 1);
  }

  // Factor and name of a unit in which the axis has numbers of one to three digits; the axis as it is without a unit.
  prefix() {
    if (!this.panel.unit) return [1, ''];
    const most = Math.max(...this.ys.map(Math.abs));
    const [factor, prefix] = PREFIXES.find(([by]) => most * by >= 1) || PREFIXES.at(-1);
    return [factor, `${prefix}${this.panel.unit}`];
  }

  // Whole decades, or multiples of a step.
  upTicks(factor) {
    const [low, high] = this.ys;
    if (!this.isLog) return ticks(factor * low, factor * high, 5).map(([value, text]) => [value / factor, text]).filter(([value]) => this.panel.scale !== 'count' || Number.isInteger(value));
    const every = Math.ceil((high - low) / 6);
    return Array.from({ length: Math.floor((high - low) / every) + 1 }, (_, k) => low + k * every).map((value) => [value, raised(value)]);
  }

  // A value that is absent leaves a gap.
  drawCurve(pen, curve, x, y) {
    pen.strokeStyle = scheme.color(curve.color);
    pen.lineWidth = curve.width;
    pen.lineJoin = 'round';
    pen.setLineDash(dashes(curve.dash));
    pen.beginPath();
    let isOpen = false;
    let before = NaN;
    curve.x.forEach((time, i) => {
      const value = curve.y[i];
      if (Number.isNaN(value)) { isOpen = false; return; }
      if (isOpen && curve.steps) pen.lineTo(x(time), y(before));
      if (isOpen) pen.lineTo(x(time), y(value)); else pen.moveTo(x(time), y(value));
      [isOpen, before] = [true, value];
    });
    pen.stroke();
    pen.setLineDash([]);
  }

  // Value of a curve at a time, NaN outside of it.
  valueAt(curve, time) {
    // The ends of packed times are rounded.
    const slack = 1e-8 * (this.xs[1] - this.xs[0]);
    if (!(time >= curve.x[0] - slack && time <= curve.x[curve.x.length - 1] + slack)) return NaN;
    const place = placeIn(curve.x, time);
    const value = curve.steps ? curve.y[place.from] : between(curve.y, place);
    return this.isLog ? 10 ** value : value;
  }

  // The cursor of the replay, and that of the pointer, with the values there.
  draw() {
    if (!this.layer) return;
    const pen = this.canvas.getContext('2d');
    const [x] = this.scales(this.width);
    pen.drawImage(this.layer, 0, 0, this.width, PLOT_HEIGHT);
    const upright = (time, color, wide) => {
      if (!(time >= this.xs[0] && time <= this.xs[1])) return;
      pen.fillStyle = color;
      pen.fillRect(x(time) - wide / 2, ROOM.top, wide, PLOT_HEIGHT - ROOM.top - ROOM.bottom);
    };
    const cursor = this.player?.time;
    upright(cursor, scheme.look.ink, 2);
    upright(this.pointed, scheme.look.soft, 1);
    this.tell(this.pointed ?? cursor ?? this.xs[0]);
    this.canvas.dataset.cursor = cursor;
  }

  // Values at a time, and for programs the same as numbers.
  tell(time) {
    const of = this.panel.curves.map((curve) => [curve, this.valueAt(curve, time)]);
    const item = (color, dash, text) => {
      const sample = element('i', {});
      sample.style.borderTop = `3px ${dash ? 'dashed' : 'solid'} ${scheme.color(color)}`;
      return element('span', {}, sample, text);
    };
    const { unit } = this.panel;
    const was = ({ before }) => (before ? ` (before ${text(this.valueAt(before, time))})` : '');
    const text = (value) => (Number.isNaN(value) ? '–' : unit ? withPrefix(value, unit) : Number.isInteger(value) && Math.abs(value) < 1e4 ? String(value) : Math.abs(value) < 1e-3 || Math.abs(value) >= 1e6 ? value.toExponential(3) : value.toPrecision(4));
    this.values.replaceChildren(element('b', {}, `${time.toFixed(3)} s`),
      ...of.map(([curve, value]) => item(curve.color, curve.dash, `${curve.label} ${text(value)}${was(curve)}`)),
      ...this.panel.levels.map((level) => item(level.color, level.dash, `${level.label} ${text(level.y)}`)));
    this.canvas.dataset.time = time;
    this.canvas.dataset.values = JSON.stringify(Object.fromEntries(of.map(([curve, value]) => [curve.label, Number.isNaN(value) ? null : value])));
  }

  get name() {
    return `${this.number}-${this.panel.y.replace(/ *\(.*/, '').replace(/[^a-z0-9]+/gi, '-')}`;
  }

  // With its legend, twice as fine as the page.
  saveImage() {
    const canvas = element('canvas', {});
    const pen = sized(canvas, this.width, PLOT_HEIGHT + 22 * Math.ceil((this.panel.curves.length + this.panel.levels.length) / 3), 2);
    pen.fillStyle = scheme.look.back;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    this.drawAxes(pen, this.width);
    [...this.panel.curves, ...this.panel.levels].forEach(({ label, color, dash }, i) => {
      const [x, y] = [ROOM.left + (i % 3) * (this.width - ROOM.left) / 3, PLOT_HEIGHT + 14 + 22 * Math.floor(i / 3)];
      pen.strokeStyle = scheme.color(color);
      pen.lineWidth = 2;
      pen.setLineDash(dashes(dash));
      pen.beginPath();
      pen.moveTo(x, y - 4);
      pen.lineTo(x + 24, y - 4);
      pen.stroke();
      write(pen, label, x + 30, y, 'left', scheme.look.ink, '12px');
    });
    saveImage(canvas, this.name);
  }

  // One line a point, as the points of the curves differ.
  saveTable() {
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const lines = [['curve', this.panel.x, this.panel.unit ? `${this.panel.y} (${this.panel.unit})` : this.panel.y].map(quoted).join(',')];
    const all = this.panel.curves.flatMap((curve) => [curve, ...(curve.before ? [{ ...curve, ...curve.before, label: `${curve.label}, before` }] : [])]);
    for (const curve of all) {
      curve.x.forEach((time, i) => {
        const value = this.isLog ? 10 ** curve.y[i] : curve.y[i];
        if (!Number.isNaN(value)) lines.push(`${quoted(curve.label)},${Number(time.toPrecision(10))},${Number(value.toPrecision(9))}`);
      });
    }
    save(new Blob([`${lines.join('\n')}\n`], { type: 'text/csv' }), `${this.name}.csv`);
  }
}

class Curves {
  constructor(figure, data, player) {
    const plots = data.map((panel, at) => new Plot(panel, at + 1, player));
    figure.querySelector('.plots').replaceChildren(...plots.map((plot) => plot.box));
    player?.followers.push(() => plots.forEach((plot) => plot.draw()));
    figure.addEventListener('keydown', (event) => player?.onKey(event));
    plots.forEach((plot) => plot.resize());
  }
}
