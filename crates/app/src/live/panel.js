// The panel beside the drawing: the scene, its parameters, and how the backends run.

const RAPIER = {
  settings: ['recommended', 'engine-defaults'],
  friction: ['aligned', 'polygon', 'box'],
  springs: ['joint', 'aggregate', 'force'],
  precision: ['f64', 'f32'],
};

// What a first visit may try, each with a button that does it.
const TRIALS = [
  ['Play the scene, then move the bar below the drawing', 'Play', (live) => live.toggle()],
  ['Make the inertia larger: the pale curves are those before', 'Inertia × 10', (live, panel) => panel.multiply('inertia', 10)],
  ['Drag a ring at the end of a spring, or a grey pusher, by mouse or finger', 'Show the start', (live) => live.goTo(0)],
  ['Edit the scene: take a point, or add a wall', 'Edit', (live) => live.setEditing(!live.editor.isOn)],
  ['Nothing is lost: take the last change back', 'Undo', (live) => live.keeper.go(-1)],
];
const TRIED = 'cohaul tried';

class Panel {
  // `change` sends what changes the scene, and `live` returns the drawing.
  constructor(place, { send, change, live }) {
    Object.assign(this, { place, send, change, live, sliders: new Map() });
  }

  // Changes a parameter by a factor, as far as its slider goes.
  multiply(key, factor) {
    const { value, most } = this.scene.parameters.find((parameter) => parameter.key === key);
    this.change({ do: 'set', what: key, value: Math.min(factor * value, most) }, true);
  }

  trials() {
    const items = TRIALS.map(([text, name, act]) => element('li', {}, `${text}. `, button(name, '', () => act(this.live(), this), 'small')));
    const box = element('details', { class: 'trials' }, element('summary', {}, 'Try this'), element('ol', {}, ...items));
    box.open = store.get(TRIED) !== 'yes';
    box.addEventListener('toggle', () => store.set(TRIED, box.open ? 'no' : 'yes'));
    return box;
  }

  show(scene) {
    this.scene = scene;
    const keys = scene.parameters.map((parameter) => parameter.key).join();
    if (keys !== this.keys) {
      this.keys = keys;
      this.build();
    }
    for (const parameter of scene.parameters) this.sliders.get(parameter.key).show(parameter);
    const { settings, all_backends: all, steps_s: steps, control_period_s: period } = scene;
    all.forEach((kind, i) => {
      this.backends[i].checked = settings.backends.includes(kind);
      const step = { key: kind, name: `step of ${kind}`, unit: 's', about: 'Longest time step', value: steps[i], least: period / 1000, most: period, is_log: true };
      this.steps[i].show(step);
    });
    for (const [key, select] of Object.entries(this.rapier)) select.value = settings.rapier[key];
  }

  build() {
    const { all_backends: all } = this.scene;
    this.sliders.clear();
    const sliders = this.scene.parameters.map((parameter) => {
      const slider = new Slider((value, isNew) => this.change({ do: 'set', what: parameter.key, value }, isNew));
      this.sliders.set(parameter.key, slider);
      return slider.box;
    });
    this.backends = all.map((kind) => {
      const box = element('input', { type: 'checkbox', name: kind });
      box.addEventListener('change', () => this.choose(box));
      return box;
    });
    this.steps = all.map((_, i) => new Slider((value, isNew) => this.settings((settings) => { settings.steps_s[i] = value; }, isNew)));
    this.rapier = Object.fromEntries(Object.entries(RAPIER).map(([key, names]) => {
      const select = element('select', { name: key, 'aria-label': `${key} of rapier` }, ...names.map((name) => element('option', { value: name }, name)));
      select.addEventListener('change', () => this.settings(({ rapier }) => {
        rapier[key] = select.value;
        // The engine as it is shipped has the simplest friction.
        if (key === 'settings') rapier.friction = select.value === 'recommended' ? 'aligned' : 'box';
      }));
      return [key, select];
    }));
    const labelled = (control, text) => element('label', {}, control, ` ${text}`);
    this.place.replaceChildren(
      element('div', { class: 'scenes' }, this.scenes(), this.opener()),
      this.trials(),
      element('h2', {}, 'Parameters'), ...sliders,
      element('h2', {}, 'Backends'), ...all.map((kind, i) => element('div', { class: 'pair' }, labelled(this.backends[i], kind), term(kind, '?'))),
      element('details', {}, element('summary', {}, 'Steps and options of rapier'), ...this.steps.map((step) => step.box),
        ...Object.entries(this.rapier).map(([key, select]) => element('label', { class: 'pair' }, `${key} `, select))));
  }

  // The last backend stays.
  choose(box) {
    if (!this.backends.some((other) => other.checked)) box.checked = true;
    else this.settings((settings) => { settings.backends = this.scene.all_backends.filter((_, i) => this.backends[i].checked); });
  }

  settings(change, isNew = true) {
    const settings = structuredClone(this.scene.settings);
    change(settings);
    this.change({ do: 'settings', settings }, isNew);
  }

  scenes() {
    const select = element('select', { name: 'scene', 'aria-label': 'Scenes that come with cohaul' }, element('option', { value: '' }, 'Scenes …'),
      ...Object.entries(Object.groupBy(this.scene.shipped, (name) => name.split('/')[0])).map(([folder, names]) => element('optgroup', { label: folder },
        ...names.map((name) => element('option', { value: name }, name.slice(folder.length + 1).replaceAll('-', ' '))))));
    select.addEventListener('change', () => { if (select.value) this.send({ do: 'shipped', name: select.value }); select.value = ''; });
    return select;
  }

  // A scenario or a saved state out of a file.
  opener() {
    const input = element('input', { type: 'file', accept: '.json,application/json', hidden: '' });
    input.addEventListener('change', async () => {
      const [file] = input.files;
      input.value = '';
      if (file) this.open(await file.text());
    });
    return element('span', {}, button('Open file', 'A scenario file', () => input.click()), input);
  }

  open(text) {
    let read;
    try {
      read = JSON.parse(text);
    } catch (error) {
      told(`the file must be JSON: ${error.message}`);
      return;
    }
    this.send({ do: 'open', saved: read.scenario && read.settings ? read : { scenario: read } });
  }
}

// A number with its name, by equal factors or by equal steps.
class Slider {
  // `act` takes the value, and whether it is the first of one movement.
  constructor(act) {
    this.input = element('input', { type: 'range', min: 0, max: 1000, step: 1 });
    this.name = element('span', {});
    this.value = element('output', {});
    this.box = element('label', { class: 'slider' }, this.name, this.value, this.input);
    this.input.addEventListener('input', () => {
      const share = this.input.value / 1000;
      const { least, most, is_log: isLog } = this.shown;
      const value = isLog ? least * (most / least) ** share : least + share * (most - least);
      this.tell(value);
      // One change at a time, the last one wins.
      this.wanted = value;
      this.asked ??= requestAnimationFrame(() => { this.asked = undefined; act(this.wanted, !this.isMoving); this.isMoving = true; });
    });
    this.input.addEventListener('change', () => {
      if (this.asked !== undefined) { cancelAnimationFrame(this.asked); this.asked = undefined; act(this.wanted, !this.isMoving); }
      this.isMoving = false;
    });
  }

  show(parameter) {
    this.shown = parameter;
    const { key, name, about, value, least, most, is_log: isLog } = parameter;
    this.input.name = key;
    this.name.textContent = name;
    this.box.title = about;
    this.tell(value);
    if (this.asked !== undefined || (document.activeElement === this.input && this.input.matches(':active'))) return;
    this.input.value = Math.round(1000 * (isLog ? Math.log(value / least) / Math.log(most / least) : (value - least) / (most - least)));
  }

  tell(value) {
    const { unit } = this.shown;
    const text = unit === 'kg' ? withPrefix(1000 * value, 'g') : unit && unit !== '×' ? withPrefix(value, unit) : `${Number(value.toPrecision(3))}${unit}`;
    this.value.textContent = text;
    this.input.setAttribute('aria-valuetext', text);
  }
}
