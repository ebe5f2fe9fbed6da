// SPDX-License-Identifier: Apache-2.0
// Builds elements. Every text becomes a text node, so names from users are never markup, and styles are set
// through the CSSOM, as the content security policy demands.

const kSvg = 'http://www.w3.org/2000/svg';

// h('button.primary', {type: 'button', onclick: f}, 'Text', child, [more]): properties that are null or false
// are left out; `on...` are event listeners; children that are null or false are left out.
export function h(tag, properties = {}, ...children) {
  const [name, ...classes] = tag.split('.');
  return fill(document.createElement(name), classes, properties, children);
}

export function svg(tag, properties = {}, ...children) {
  return fill(document.createElementNS(kSvg, tag), [], properties, children);
}

function fill(element, classes, properties, children) {
  if (classes.length > 0) element.classList.add(...classes);
  for (const [key, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else element.setAttribute(key, value === true ? '' : value);
  }
  element.append(
    ...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false),
  );
  return element;
}

// Touches the document only if something changes, so that selections survive and nothing is laid out again.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function setAttribute(element, name, value) {
  if (value === null || value === undefined || value === false) {
    if (element.hasAttribute(name)) element.removeAttribute(name);
  } else if (element.getAttribute(name) !== String(value === true ? '' : value)) {
    element.setAttribute(name, value === true ? '' : value);
  }
}

export function setHidden(element, hidden) {
  if (element.hidden !== hidden) element.hidden = hidden;
}

// Puts `wanted` into `parent` in this order, moving as few elements as possible.
export function setChildren(parent, wanted) {
  const keep = new Set(wanted);
  for (const child of [...parent.children]) if (!keep.has(child)) child.remove();
  let next = parent.firstElementChild;
  for (const element of wanted) {
    if (element === next) next = next.nextElementSibling;
    else parent.insertBefore(element, next);
  }
}

const kIcons = {
  pause: 'M5 3h2.5v10H5zM8.5 3H11v10H8.5z',
  resume: 'M5 3l8 5-8 5z',
  cancel: 'M4 4h8v8H4z',
  extend: 'M7 3h2v4h4v2H9v4H7V9H3V7h4z',
  priority: 'M8 2l5 6H9.5v6h-3V8H3z',
  delete: 'M6 2h4l1 1h3v1.5H2V3h3zM3.5 6h9L12 14H4z',
  more: 'M3 6.75h2.5v2.5H3zM6.75 6.75h2.5v2.5h-2.5zM10.5 6.75H13v2.5h-2.5z',
  theme: 'M8 1.5a6.5 6.5 0 1 1 0 13 6.5 6.5 0 0 1 0-13zM8 3a5 5 0 0 0 0 10z',
  download: 'M7 2h2v6h3l-4 4-4-4h3zM3 13h10v1.5H3z',
  back: 'M10 3l1.2 1.2L7.4 8l3.8 3.8L10 13 5 8z',
  forward: 'M6 3L4.8 4.2 8.6 8l-3.8 3.8L6 13l5-5z',
  leave: 'M2.5 2h6v1.5H4v9h4.5V14h-6zM10 4.5L13.5 8 10 11.5 9 10.5l1.7-1.7H6V7.2h4.7L9 5.5z',
  undo: 'M6 3v2.5h3a4 4 0 0 1 0 8H5V12h4a2.5 2.5 0 0 0 0-5H6v2.5L2.5 6.2z',
  fit: 'M2 2h4v1.5H3.5V6H2zM10 2h4v4h-1.5V3.5H10zM2 10h1.5v2.5H6V14H2zM12.5 10H14v4h-4v-1.5h2.5z',
  plus: 'M7 3h2v4h4v2H9v4H7V9H3V7h4z',
  minus: 'M3 7h10v2H3z',
  camera: 'M6 3h4l1 1.5h3v8.5H2V4.5h3zM8 6a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z',
};

export function icon(name) {
  return svg(
    'svg',
    {class: 'icon', viewBox: '0 0 16 16', 'aria-hidden': 'true', focusable: 'false'},
    svg('path', {d: kIcons[name], 'fill-rule': 'evenodd'}),
  );
}

let ids = 0;
export function uniqueId(prefix) {
  ids += 1;
  return `${prefix}-${ids}`;
}

// A labelled form field: [label, control].
export function field(label, control, hint = null) {
  control.id ||= uniqueId('field');
  return h('div.field', {}, h('label', {for: control.id}, label), control, hint && h('p.hint', {}, hint));
}

export function select(options, value, onchange, properties = {}) {
  return h(
    'select',
    {...properties, onchange: (event) => onchange(event.target.value)},
    options.map(([key, text]) => h('option', {value: key, selected: key === value}, text)),
  );
}

// At most one call in `milliseconds`; the last one counts.
export function throttle(milliseconds, call) {
  let timer = 0;
  let last = 0;
  return () => {
    if (timer) return;
    const wait = Math.max(0, last + milliseconds - performance.now());
    timer = setTimeout(() => {
      timer = 0;
      last = performance.now();
      call();
    }, wait);
  };
}
