// SPDX-License-Identifier: Apache-2.0
// Messages, questions and menus above the page.
import {field, h, icon, setAttribute} from './dom.js';

const kToastSeconds = 8;

// A message that goes by itself, with an optional action such as Undo. Errors stay until they are closed.
export function toast(message, {isError = false, action = null} = {}) {
  const close = () => element.remove();
  const element = h(
    'div.toast',
    {class: isError ? 'toast-error' : null, role: isError ? 'alert' : null},
    h('span.toast-text', {}, message),
    action &&
      h(
        'button.quiet',
        {
          type: 'button',
          onclick: () => {
            close();
            action.run();
          },
        },
        icon('undo'),
        action.label,
      ),
    h('button.quiet', {type: 'button', onclick: close, 'aria-label': 'Close the message'}, '✕'),
  );
  const list = document.getElementById('toasts');
  list.append(element);
  while (list.children.length > 4) list.firstElementChild.remove();
  if (isError) return;
  let timer = setTimeout(close, 1000 * kToastSeconds);
  const hold = () => clearTimeout(timer);
  const release = () => {
    timer = setTimeout(close, 1000 * kToastSeconds);
  };
  element.addEventListener('pointerenter', hold);
  element.addEventListener('pointerleave', release);
  element.addEventListener('focusin', hold);
  element.addEventListener('focusout', release);
}

export function toastError(error) {
  if (error.name === 'AbortError') return;
  toast(error.message, {isError: true});
}

function showDialog(title, content, buttons) {
  const heading = h('h2', {id: 'dialog-title'}, title);
  const dialog = h(
    'dialog.dialog',
    {'aria-labelledby': 'dialog-title'},
    h('form', {method: 'dialog'}, heading, content, h('div.dialog-buttons', {}, buttons)),
  );
  document.body.append(dialog);
  return new Promise((resolve) => {
    dialog.addEventListener('close', () => {
      resolve(dialog.returnValue);
      dialog.remove();
    });
    dialog.showModal();
  });
}

// Not a submit button: Enter in a field accepts.
function cancelButton(isFocused = false) {
  const close = (event) => event.target.closest('dialog').close('');
  return h('button', {type: 'button', autofocus: isFocused, onclick: close}, 'Keep as it is');
}

// Resolves to true if confirmed.
export async function confirm(title, content, {label, isDanger = false}) {
  const accept = h('button', {class: isDanger ? 'danger' : 'primary', type: 'submit', value: 'yes'}, label);
  return (await showDialog(title, content, [cancelButton(true), accept])) === 'yes';
}

// Asks for a whole number; resolves to it, or to null.
export async function askNumber(title, {label, value, min, max, hint, accept}) {
  const input = h('input', {type: 'number', required: true, step: 1, min, max, value, autofocus: true});
  const button = h('button.primary', {type: 'submit', value: 'yes'}, accept);
  const answer = await showDialog(title, field(label, input, hint), [cancelButton(), button]);
  return answer === 'yes' && input.value !== '' ? Number(input.value) : null;
}

export function inform(title, content) {
  return showDialog(title, content, h('button.primary', {type: 'submit', autofocus: true}, 'Close'));
}

// A button that opens a menu. items(): [{label, icon, run, reason, isDanger}]; an item with a reason is
// disabled, can still be reached, and says why.
export function menuButton(label, content, items, properties = {}) {
  const button = h(
    'button',
    {
      type: 'button',
      'aria-haspopup': 'menu',
      'aria-expanded': 'false',
      'aria-label': label,
      title: label,
      ...properties,
    },
    content,
  );
  button.addEventListener('click', () => openMenu(button, label, items()));
  return button;
}

function openMenu(button, label, items) {
  document.querySelector('.menu')?.hidePopover();
  const menu = h('div.menu', {popover: 'auto', role: 'menu', 'aria-label': label}, items.map(menuItem));
  document.body.append(menu);
  menu.addEventListener('toggle', (event) => {
    setAttribute(button, 'aria-expanded', String(event.newState === 'open'));
    if (event.newState !== 'closed') return;
    if (menu.contains(document.activeElement)) button.focus();
    menu.remove();
  });
  menu.addEventListener('click', (event) => {
    if (event.target.closest('[aria-disabled]')) return;
    button.focus();
    menu.hidePopover();
  });
  menu.addEventListener('keydown', (event) => moveInMenu(event, menu));
  menu.showPopover();
  placeBelow(menu, button);
  menu.firstElementChild.focus();
}

// A reason that the item before has as well is not repeated.
function menuItem({label, icon: name, run, reason, isDanger, href}, at, items) {
  const properties = {
    role: 'menuitem',
    tabindex: -1,
    title: reason,
    'aria-disabled': reason ? 'true' : null,
    class: isDanger ? 'menu-item danger-text' : 'menu-item',
  };
  const note = reason && reason !== items[at - 1]?.reason && h('small', {}, reason);
  const content = [name ? icon(name) : null, h('span', {}, label), note];
  if (href) return h('a', {...properties, href, download: true}, content);
  return h('button', {...properties, type: 'button', onclick: () => !reason && run()}, content);
}

function moveInMenu(event, menu) {
  const items = [...menu.children];
  const at = items.indexOf(document.activeElement);
  const next = {ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: items.length - 1}[event.key];
  if (event.key === 'Tab') menu.hidePopover();
  if (next === undefined) return;
  event.preventDefault();
  event.stopPropagation();
  items[(next + items.length) % items.length].focus();
}

function placeBelow(menu, button) {
  const anchor = button.getBoundingClientRect(),
    own = menu.getBoundingClientRect();
  const below = anchor.bottom + own.height + 8 < innerHeight;
  menu.style.top = `${Math.max(8, below ? anchor.bottom + 4 : anchor.top - own.height - 4)}px`;
  menu.style.left = `${Math.max(8, Math.min(anchor.right - own.width, innerWidth - own.width - 8))}px`;
}

// Disables a button with a reason that pointer and screen reader users get; it stays focusable.
export function setReason(button, reason, hint = null) {
  setAttribute(button, 'aria-disabled', reason ? 'true' : null);
  setAttribute(button, 'title', reason ?? hint);
}

// A click on a disabled button says why it is disabled.
export function guarded(run) {
  return (event) => {
    const button = event.currentTarget;
    if (button.getAttribute('aria-disabled') === 'true') toast(button.title);
    else run(event);
  };
}
