// What all parts of the script use: packed numbers, elements, units, colours, and files for the reader.

const NO_VALUE = { 16: -32768, 32: -2147483648 };

// Series of numbers out of fixed point; NaN stands for no value. A series that is none comes as it is.
function unpack(packed) {
  if (Array.isArray(packed)) return packed;
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

// The data beside a figure.
function dataOf(figure) {
  return JSON.parse(figure.querySelector('script').textContent);
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

const PREFIXES = [[1e-3, 'k'], [1, ''], [1e3, 'm'], [1e6, 'µ'], [1e9, 'n']];

function withPrefix(value, unit) {
  if (value === 0) return `0 ${unit}`;
  for (const [factor, prefix] of PREFIXES) {
    if (Math.abs(value) * factor >= 0.9995) return `${(value * factor).toPrecision(4)} ${prefix}${unit}`;
  }
  return `${value.toExponential(2)} ${unit}`;
}

// The 1, 2 or 5 times a power of ten that is the largest one up to `most`.
function niceBelow(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return power * (most / power >= 5 ? 5 : most / power >= 2 ? 2 : 1);
}

function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function button(text, title, act, name = '') {
  const made = element('button', { type: 'button', title, class: name }, text);
  made.addEventListener('click', act);
  return made;
}

// Gives a canvas its size on the page (px), as fine as the screen, and returns its pen.
function sized(canvas, width, height, density = window.devicePixelRatio || 1) {
  canvas.width = Math.round(width * density);
  canvas.height = Math.round(height * density);
  canvas.style.height = `${height}px`;
  const pen = canvas.getContext('2d');
  pen.setTransform(density, 0, 0, density, 0, 0);
  return pen;
}

function write(pen, text, x, y, align, color, font = '13px') {
  pen.font = `${font} system-ui, "DejaVu Sans", Verdana, sans-serif`;
  pen.textAlign = align;
  pen.fillStyle = color;
  pen.fillText(text, x, y);
}

// Colours of canvases, and the colours of traces for a dark page: as printed they stand on white.
const LIGHT = { back: '#ffffff', ink: '#1c1d1f', soft: '#777d85', faint: '#dcdcd8' };
const DARK = { back: '#1e2125', ink: '#e8e8e4', soft: '#9aa0a8', faint: '#3d4249' };
const LIGHTER = { '#0072B2': '#4aa8e8', '#D55E00': '#ff8d45', '#000000': '#f0f0f0', '#009E73': '#2fc796' };

// Light or dark: as the system says, until the reader chooses.
const scheme = {
  system: matchMedia('(prefers-color-scheme: dark)'),
  listeners: [],
  get isDark() {
    const chosen = document.documentElement.dataset.scheme;
    return chosen ? chosen === 'dark' : this.system.matches;
  },
  get look() {
    return this.isDark ? DARK : LIGHT;
  },
  color(color) {
    return (this.isDark && LIGHTER[color]) || color;
  },
  changed() {
    for (const listener of this.listeners) listener();
  },
  // Adds the switch to the head of the page.
  begin() {
    const made = button('Dark page', 'Changes between a light and a dark page', () => {
      document.documentElement.dataset.scheme = this.isDark ? 'light' : 'dark';
      this.changed();
    }, 'scheme');
    const show = () => made.setAttribute('aria-pressed', this.isDark);
    this.listeners.push(show);
    this.system.addEventListener('change', () => this.changed());
    document.querySelector('header').prepend(made);
    show();
  },
};

// Hands a file to the reader, named after the page.
function save(blob, what) {
  const page = document.title.normalize('NFKD').replace(/[^A-Za-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 60);
  const link = element('a', { href: URL.createObjectURL(blob), download: `${page}-${what}`.toLowerCase() });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

function saveImage(canvas, what) {
  canvas.toBlob((blob) => save(blob, `${what}.png`), 'image/png');
}
