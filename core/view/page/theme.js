// SPDX-License-Identifier: Apache-2.0
// Applies the chosen theme before the first paint. Without a choice, the style sheet follows the system.
(() => {
  try {
    const theme = localStorage.getItem('tessera-theme');
    if (theme === 'dark' || theme === 'light') document.documentElement.dataset.theme = theme;
  } catch {
    // Storage is blocked: the system's theme applies.
  }
})();
