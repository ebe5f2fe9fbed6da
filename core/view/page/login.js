// SPDX-License-Identifier: Apache-2.0
// The login form. The token goes to the server once, which keeps it in a cookie that scripts cannot read.
import {post} from './api.js';
import {field, h, setHidden, setText} from './dom.js';

export function loginView(root, onLogin) {
  const token = h('input', {
    type: 'password',
    autocomplete: 'current-password',
    required: true,
    spellcheck: 'false',
    name: 'token',
  });
  const error = h('p.error', {role: 'alert', hidden: true});
  const button = h('button.primary', {type: 'submit'}, 'Log in');
  const submit = async (event) => {
    event.preventDefault();
    button.disabled = true;
    try {
      await post('session', {token: token.value.trim()});
      await onLogin();
    } catch (failure) {
      setText(
        error,
        failure.status === 401
          ? 'This token is not known. Check it for missing characters.'
          : failure.message,
      );
      setHidden(error, false);
      token.focus();
    } finally {
      button.disabled = false;
    }
  };
  root.append(
    h(
      'form.login.panel',
      {onsubmit: submit},
      h('h1', {tabindex: -1}, 'Log in'),
      h(
        'p',
        {},
        'This farm asks for the token that its operator gave you, the same that ',
        h('code', {}, 'tessera --token-file'),
        ' reads.',
      ),
      // For password managers, which want a name.
      h('input', {type: 'text', name: 'username', autocomplete: 'username', value: 'tessera', hidden: true}),
      field('Token', token),
      error,
      button,
    ),
  );
  return {title: 'Log in', keys: [], close() {}, focus: () => token.focus()};
}
