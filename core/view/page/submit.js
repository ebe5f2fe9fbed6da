// SPDX-License-Identifier: Apache-2.0
// Submits a scene: drop its folder, files or zip archive, look at what is sent, and go.
import {whyNotSubmit} from './access.js';
import {bundleOf, findScenes, fromDrop, fromInput, sceneName} from './bundle_files.js';
import {guarded, setReason, toast} from './dialogs.js';
import {field, h, setAttribute, setHidden, setText, svg} from './dom.js';
import {bytes, percent, plural} from './format.js';
import {store} from './store.js';
import {submitBundle, untilValidated} from './upload.js';

const kShownFiles = 100;
const kMaxName = 200;

function numberInput(properties) {
  return h('input', {type: 'number', step: 1, placeholder: 'as in the scene', ...properties});
}

export function submitView(root) {
  const view = new SubmitView(root);
  return {title: 'Submit a scene', keys: [], close: () => view.close()};
}

class SubmitView {
  constructor(root) {
    this.files = [];
    this.bundle = [];
    this.running = new AbortController();
    this.buildSource();
    this.buildOptions();
    this.buildOutcome();
    root.append(
      h(
        'div.submit',
        {},
        h('h1', {tabindex: -1}, 'Submit a scene'),
        h(
          'p.lead',
          {},
          'The scene file and what it names are sent to the farm. Files that the farm has are not sent ' +
            'again.',
        ),
        this.drop,
        this.form,
        this.outcome,
      ),
    );
    this.onDrag = (event) => this.drag(event);
    for (const type of ['dragover', 'dragleave', 'drop']) document.addEventListener(type, this.onDrag);
    this.update();
  }

  close() {
    this.running.abort();
    for (const type of ['dragover', 'dragleave', 'drop']) document.removeEventListener(type, this.onDrag);
  }

  buildSource() {
    const choose = (properties) =>
      h('input.visually-hidden', {
        type: 'file',
        multiple: true,
        tabindex: -1,
        'aria-hidden': 'true',
        ...properties,
        onchange: (event) => this.take(() => fromInput(event.target.files)),
      });
    this.folderInput = choose({webkitdirectory: true});
    this.fileInput = choose({});
    const button = (label, input, isFirst) =>
      h(
        'button',
        {
          type: 'button',
          class: isFirst ? 'primary' : null,
          onclick: guarded(() => {
            input.value = '';
            input.click();
          }),
        },
        label,
      );
    this.pickers = [
      button('Choose a folder', this.folderInput, true),
      button('Choose files or a zip', this.fileInput),
    ];
    this.drop = h(
      'section.drop',
      {'aria-label': 'Files of the scene'},
      svg(
        'svg',
        {class: 'drop-art', viewBox: '0 0 48 48', 'aria-hidden': 'true'},
        svg('path', {d: 'M6 14h14l4 5h18v19H6z M24 24v9 M20 29l4-4 4 4'}),
      ),
      h('p.drop-text', {}, 'Drop a scene folder, files or a zip archive anywhere on this page'),
      h('div.button-row', {}, this.pickers),
      h('p.hint', {}, 'In a terminal: ', h('code', {}, 'tessera submit scene.json')),
      this.folderInput,
      this.fileInput,
    );
  }

  buildOptions() {
    this.scene = h('select', {onchange: () => this.chooseScene()});
    this.isAll = h('input', {type: 'checkbox', onchange: () => this.chooseScene()});
    this.summary = h('p.hint', {role: 'status'});
    this.list = h('ul.file-list', {});
    this.name = h('input', {
      type: 'text',
      maxlength: kMaxName,
      autocomplete: 'off',
    });
    this.width = numberInput({min: 1});
    this.height = numberInput({min: 1});
    this.spp = numberInput({min: 1});
    this.priority = h('input', {type: 'number', step: 1, value: 0});
    this.maxWorkers = h('input', {type: 'number', step: 1, min: 0, placeholder: 'no limit'});
    this.labels = h('input', {type: 'text', autocomplete: 'off', placeholder: 'shot=12, take=b'});
    this.button = h('button.primary', {type: 'submit'}, 'Submit');
    this.form = h(
      'form.panel.submit-form',
      {hidden: true, onsubmit: (event) => this.submit(event)},
      field('Scene file', this.scene),
      h('details.files', {}, h('summary', {}, this.summary), this.list),
      h('label.check', {}, this.isAll, ' Send all files, also those that the scene does not seem to name'),
      h(
        'div.field-grid',
        {},
        field('Name', this.name),
        field('Samples per pixel', this.spp),
        field('Width', this.width),
        field('Height', this.height),
        field('Priority', this.priority),
        field('Workers at most', this.maxWorkers),
        field('Labels', this.labels),
      ),
      h('div.button-row', {}, this.button),
    );
  }

  buildOutcome() {
    this.bar = svg('rect', {class: 'bar-done', x: 0, y: 0, width: 0, height: 4});
    this.stage = h('p', {role: 'status'});
    this.progress = h(
      'div.upload',
      {hidden: true},
      this.stage,
      svg(
        'svg',
        {class: 'bar', viewBox: '0 0 100 4', preserveAspectRatio: 'none', 'aria-hidden': 'true'},
        this.bar,
      ),
    );
    this.messages = h('pre.terminal', {
      hidden: true,
      role: 'alert',
      tabindex: 0,
      'aria-label': 'Messages about the scene',
    });
    this.outcome = h('div.outcome', {}, this.progress, this.messages);
  }

  update() {
    const reason = whyNotSubmit();
    for (const picker of this.pickers) setReason(picker, reason);
    setReason(this.button, reason);
  }

  drag(event) {
    event.preventDefault();
    const isOver = event.type === 'dragover';
    this.drop.classList.toggle('is-over', isOver && !whyNotSubmit());
    if (event.type !== 'drop') return;
    if (whyNotSubmit()) toast(whyNotSubmit());
    else this.take(() => fromDrop(event.dataTransfer));
  }

  async take(collect) {
    this.showMessages([]);
    setHidden(this.progress, true);
    try {
      this.files = await collect();
    } catch (error) {
      this.files = [];
      this.showMessages([`tessera: error: ${error.message}`]);
    }
    const scenes = findScenes(this.files);
    setHidden(this.form, scenes.length === 0);
    if (scenes.length === 0) {
      if (this.files.length > 0)
        this.showMessages([
          `tessera: error: there is no scene (.json, .gltf, .glb, .pbrt, .xml, .obj, .ply, .stl) among ` +
            plural(this.files.length, 'file'),
        ]);
      return;
    }
    this.scene.replaceChildren(...scenes.map(({path}) => h('option', {value: path}, path)));
    await this.chooseScene();
    this.button.focus();
  }

  async chooseScene() {
    const scene = this.files.find(({path}) => path === this.scene.value);
    this.name.placeholder = sceneName(scene.path).slice(0, kMaxName);
    this.bundle = await bundleOf(scene, this.files, this.isAll.checked);
    const distinct = new Set(this.bundle.map(({file}) => file));
    const size = [...distinct].reduce((sum, file) => sum + file.size, 0);
    setText(
      this.summary,
      `${plural(distinct.size, 'file')}, ${bytes(size)}` +
        (distinct.size < this.files.length ? `, of ${this.files.length} given` : ''),
    );
    this.list.replaceChildren(
      ...this.bundle
        .slice(0, kShownFiles)
        .map(({path, file}) =>
          h('li', {}, h('span.file-name', {}, path), h('span.number', {}, bytes(file.size))),
        ),
      this.bundle.length > kShownFiles ? h('li', {}, `and ${this.bundle.length - kShownFiles} more`) : '',
    );
    this.size = size;
  }

  // What exceeds the farm's limits fails here rather than after an hour of uploading.
  checkLimits() {
    const {bundle_bytes: most, bundle_files: mostFiles, blob_bytes: mostBlob} = store.server.limits ?? {};
    if (most && this.size > most)
      return `the files have ${bytes(this.size)}; this farm takes at most ${bytes(most)}`;
    if (mostFiles && this.bundle.length > mostFiles)
      return `there are ${this.bundle.length} files; this farm takes at most ${mostFiles}`;
    const large = mostBlob && this.bundle.find(({file}) => file.size > mostBlob);
    return large
      ? `${large.path} has ${bytes(large.file.size)}; this farm takes at most ${bytes(mostBlob)}`
      : null;
  }

  options() {
    const overrides = {};
    for (const key of ['width', 'height', 'spp'])
      if (this[key].value !== '') overrides[key] = Number(this[key].value);
    const labels = {};
    for (const pair of this.labels.value
      .split(',')
      .map((text) => text.trim())
      .filter(Boolean)) {
      const at = pair.indexOf('=');
      labels[at < 0 ? pair : pair.slice(0, at).trim()] = at < 0 ? '' : pair.slice(at + 1).trim();
    }
    return {
      name: this.name.value.trim() || this.name.placeholder,
      overrides,
      priority: Number(this.priority.value || 0),
      max_workers: Number(this.maxWorkers.value || 0),
      labels,
    };
  }

  async submit(event) {
    event.preventDefault();
    if (whyNotSubmit() || this.isBusy) return;
    this.setBusy(true);
    this.showMessages([]);
    const {signal} = this.running;
    try {
      const limit = this.checkLimits();
      if (limit) throw new Error(limit);
      const scenePath = this.scene.value.slice(this.scene.value.lastIndexOf('/') + 1);
      const stored = await submitBundle(
        this.bundle,
        scenePath,
        this.options(),
        (...what) => this.showProgress(...what),
        signal,
      );
      this.showProgress('Validating the scene', 1, 1);
      const job = await untilValidated(stored, signal);
      if (signal.aborted) return;
      if (job.state !== 'failed') location.hash = `#/jobs/${encodeURIComponent(job.id)}`;
      else
        this.showMessages([
          ...(job.warnings ?? []).map((text) => `tessera: warning: ${text}`),
          `tessera: error: ${job.failure?.message}`,
        ]);
    } catch (error) {
      if (error.name !== 'AbortError') this.showMessages([`tessera: error: ${error.message}`]);
    }
    this.setBusy(false);
  }

  setBusy(isBusy) {
    this.isBusy = isBusy;
    this.button.disabled = isBusy;
    setHidden(this.progress, !isBusy);
  }

  showProgress(what, done, total) {
    setAttribute(this.bar, 'width', total > 0 ? ((100 * done) / total).toFixed(1) : 100);
    setText(this.stage, total > 1 ? `${what}: ${percent(done, total)}` : `${what}…`);
  }

  showMessages(lines) {
    setHidden(this.messages, lines.length === 0);
    setText(this.messages, lines.join('\n'));
  }
}
