// A drawing with what moves the view, what the signs mean, and files of it: for replays and live pages.

const FACTORS = [1, 10, 100];
const VIDEO = 'video/webm';

function readReplay(data) {
  const all = (packed) => (Array.isArray(packed) ? packed.map(all) : unpack(packed));
  for (const stage of data.stages) for (const name of ['times', 'tips', 'ants']) stage[name] = all(stage[name]);
  for (const run of data.runs) {
    for (const name of ['times', 'x', 'y', 'heading', 'vx', 'vy', 'turn_rate', 'pulls', 'contacts']) run[name] = all(run[name]);
  }
  return data;
}

class Stage extends View {
  // Whether the pointer takes something and carries it; else it moves the view.
  take() { return false; }

  carry() { return false; }

  letGo() {}

  // What has a size of its own beside the drawing.
  resized() {}

  listenToPointer() {
    const canvas = this.canvas;
    let last;
    // From the middle of the view that the pointer is on (px).
    const fromMiddle = (event) => {
      const box = canvas.getBoundingClientRect();
      const [x, y] = [event.clientX - box.left, event.clientY - box.top];
      return [(x % this.grid.width) - this.grid.width / 2, (y % this.grid.height) - this.grid.height / 2 - 12];
    };
    let isTaken = false;
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      isTaken = this.take(event);
      last = isTaken ? undefined : event;
    });
    // A finger that has taken nothing scrolls the page; this comes after `pointerdown`.
    canvas.addEventListener('touchstart', (event) => { if (isTaken) event.preventDefault(); }, { passive: false });
    canvas.addEventListener('pointermove', (event) => {
      if (this.carry(event) || !last) return;
      this.panBy(event.clientX - last.clientX, event.clientY - last.clientY);
      last = event;
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, () => { this.letGo(); last = undefined; });
    // A page that is scrolled past the drawing leaves it as it is.
    canvas.addEventListener('wheel', (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.zoomBy(ZOOM.step ** (-event.deltaY / 100), ...fromMiddle(event));
    }, { passive: false });
  }

  toggleButton(text, title, key) {
    const made = button(text, title, () => {
      this[key] = !this[key];
      made.setAttribute('aria-pressed', this[key]);
      this.resize();
    });
    made.setAttribute('aria-pressed', this[key]);
    return made;
  }

  // A choice among values, with a name before it.
  choice(name, options, chosen, act) {
    const made = element('select', { 'aria-label': name }, ...options.map(([value, text]) => element('option', { value }, text)));
    made.value = chosen;
    made.addEventListener('change', () => act(Number(made.value)));
    return element('label', {}, `${name} `, made);
  }

  viewControls() {
    const controls = [
      button('+', 'Zoom in (+)', () => this.zoomBy(ZOOM.step)), button('−', 'Zoom out (-)', () => this.zoomBy(1 / ZOOM.step)),
      button('Reset view', 'All of it in the middle (0)', () => { this.resetView(); this.draw(); }),
      this.toggleButton('Follow the load', 'Or show the whole path', 'follows'), this.toggleButton('Numbers', 'Numbers of the springs', 'numbers')];
    if (this.data.runs.length > 1) controls.push(this.toggleButton('Overlay', 'All runs in one view', 'isOverlaid'));
    if (this.data.runs.length > 1 && this.isShared) {
      const runs = this.data.runs.map((run, at) => [at, run.label]);
      controls.push(
        this.choice('differences from', runs, this.base, (base) => { this.base = base; this.signs.replaceChildren(...this.key(), this.keys); this.draw(); }),
        this.choice('drawn', FACTORS.map((factor) => [factor, `×${factor}`]), this.factor, (factor) => { this.factor = factor; this.draw(); }));
    }
    controls.push(button('PNG', 'Saves the drawing as an image', () => saveImage(this.canvas, this.what)));
    this.videoButton = button('Video', 'Plays from the start to the end and saves it as a video', () => this.record());
    if (this.canvas.captureStream && window.MediaRecorder?.isTypeSupported(VIDEO)) controls.push(this.videoButton);
    return controls;
  }

  // What the signs mean.
  key() {
    const sign = (svg, text) => {
      const made = element('span', {});
      made.innerHTML = `<svg viewBox="0 0 26 16" aria-hidden="true">${svg}</svg>`;
      made.append(text);
      return made;
    };
    const signs = [];
    if (this.data.supports.some((support) => support[2] > 0)) {
      signs.push(sign('<rect x="8" y="3" width="10" height="10" fill="#777"/>', 'sticking support'));
      signs.push(sign('<circle cx="7" cy="8" r="4.5" fill="#e69f00"/><path d="M7 8H23M18 4l5 4-5 4" stroke="#009e73" stroke-width="2" fill="none"/>', 'slipping support, slip velocity'));
      signs.push(sign('<path d="M23 8H3" stroke="#cc3311" stroke-width="3"/><path d="M9 3L2 8l7 5z" fill="#cc3311"/>', 'friction on the load'));
    }
    if (this.data.springs.length) {
      const ramp = element('canvas', { class: 'ramp', width: 90, height: 10, 'aria-hidden': 'true' });
      const pen = ramp.getContext('2d');
      for (let x = 0; x < 90; x++) { pen.fillStyle = rampColor(x / 89); pen.fillRect(x, 0, 1, 10); }
      signs.push(element('span', {}, 'pull on a spring 0', ramp, withPrefix(this.data.largest_pull, 'N')));
    }
    if (this.data.obstacles.length) {
      signs.push(sign('<path d="M3 13V3H23V13Z" fill="none" stroke="#777" stroke-width="1.5"/><path d="M3 9l6-6M4 13L14 3M9 13L19 3M14 13l9-9M19 13l4-4" stroke="#999" stroke-width="0.8"/>', 'obstacle'));
      if (this.data.force_unit > 0) signs.push(sign('<path d="M6 8H23" stroke="#7b3fa0" stroke-width="2.5"/><path d="M17 3l7 5-7 5z" fill="#7b3fa0"/><circle cx="5" cy="8" r="3.5" fill="#7b3fa0"/>', 'contact, force of an obstacle on the load'));
    }
    if (this.data.has_ants) {
      signs.push(sign('<ellipse cx="8" cy="8" rx="5" ry="3.4" fill="#a04000"/><circle cx="17" cy="8" r="2.6" fill="#a04000"/>', 'ant that pulls'));
      signs.push(sign('<ellipse cx="8" cy="8" rx="5" ry="3.4" fill="none" stroke="#888"/><circle cx="17" cy="8" r="2.6" fill="none" stroke="#888"/>', 'ant that searches'));
    }
    if (this.data.runs.length > 1) signs.push(sign('<circle cx="13" cy="8" r="6.5" fill="none" stroke="#888" stroke-dasharray="3 2"/>', `where ${this.data.runs[this.base].label} is`));
    return signs;
  }

  // Saves what is drawn from now on, until the recorder is stopped.
  startVideo(what) {
    const chunks = [];
    this.recorder = new MediaRecorder(this.canvas.captureStream(), { mimeType: VIDEO });
    this.recorder.addEventListener('dataavailable', (event) => chunks.push(event.data));
    this.recorder.addEventListener('stop', () => {
      this.recorder = undefined;
      this.videoButton.ariaPressed = 'false';
      save(new Blob(chunks, { type: VIDEO }), `${what}.webm`);
    });
    this.videoButton.ariaPressed = 'true';
    this.recorder.start();
  }

  resize() {
    const width = this.canvas.clientWidth || 300;
    const count = this.isOverlaid ? 1 : this.data.runs.length;
    const columns = width < 640 ? 1 : count;
    const rows = Math.ceil(count / columns);
    // Views below each other leave room on the screen to scroll.
    const most = rows > 1 ? Math.max(150, Math.min(260, 0.6 * window.innerHeight / rows)) : Math.max(420, count > 1 ? 0 : 0.6 * window.innerHeight);
    const height = Math.round(Math.min(Math.max(width / columns, 150), most, width < 640 ? Math.max(150, 0.6 * window.innerHeight) : Infinity));
    this.grid = { columns, width: width / columns, height };
    sized(this.canvas, width, rows * height);
    this.resized(width);
    this.draw();
  }
}
