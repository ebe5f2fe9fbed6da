// SPDX-License-Identifier: Apache-2.0
// Which image of a job is shown, if it has several, such as the frames of an animation.
import {section} from './details_panel.js';
import {h, icon, setHidden, setText} from './dom.js';
import {percent} from './format.js';

function imageText(index, image) {
  if (!image) return `Image ${index + 1}`;
  const name = image.name || `Frame ${image.frame}`;
  const isDone = image.samples_total > 0 && image.samples_done >= image.samples_total;
  return isDone ? name : `${name} – ${percent(image.samples_done, image.samples_total)}`;
}

export class ImagesPanel {
  // choose(index): another image is to be shown.
  constructor(choose) {
    this.choose = choose;
    this.count = 1;
    this.index = 0;
    this.list = h('select', {'aria-label': 'Image', onchange: () => this.choose(Number(this.list.value))});
    const step = (name, label, by) =>
      h(
        'button.icon-button',
        {type: 'button', 'aria-label': label, title: label, onclick: () => this.step(by)},
        icon(name),
      );
    this.element = section(
      'Image',
      h(
        'div.image-choice',
        {},
        step('back', 'Previous image (p)', -1),
        this.list,
        step('forward', 'Next image (i)', 1),
      ),
    );
    setHidden(this.element, true);
  }

  update({image_count: count = 1, images = []}) {
    if (count === this.count && images === this.images) return;
    this.images = images;
    setHidden(this.element, count < 2);
    if (this.count !== count || this.list.options.length !== count)
      this.list.replaceChildren(...Array.from({length: count}, (_, i) => h('option', {value: i})));
    this.count = count;
    [...this.list.options].forEach((option, i) => setText(option, imageText(i, images[i])));
    this.list.value = String(this.index);
  }

  show(index) {
    this.index = index;
    this.list.value = String(index);
  }

  // After the last one comes the first.
  step(by) {
    if (this.count > 1) this.choose((this.index + by + this.count) % this.count);
  }

  keys() {
    return [
      {key: 'i', help: 'Next image', run: () => this.step(1)},
      {key: 'p', help: 'Previous image', run: () => this.step(-1)},
    ];
  }
}
