// SPDX-License-Identifier: Apache-2.0
// Pan, zoom and point in the live image with mouse, touch and keyboard.

// Mouse wheels send steps of about 100, touchpads many small ones.
const kWheelZoom = 1.0018;
const kTapPx = 6;

export function listenToInput(viewer) {
  const {element} = viewer;
  const pointers = new Map();
  let moved = 0;

  const at = (event) => {
    const box = element.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  };
  const point = ({x, y}) => {
    const pixel = viewer.viewport.toImage(x, y);
    const [px, py] = [Math.floor(pixel.x), Math.floor(pixel.y)];
    const {imageWidth, imageHeight} = viewer.viewport;
    const isInside = px >= 0 && py >= 0 && px < imageWidth && py < imageHeight;
    viewer.setCursor(isInside ? {x: px, y: py} : null);
  };

  const handlers = {
    pointerdown(event) {
      if (event.button > 1 || event.target.closest('[role=slider]')) return;
      element.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, at(event));
      moved = 0;
      element.classList.add('is-dragged');
    },
    pointermove(event) {
      const now = at(event),
        before = pointers.get(event.pointerId);
      if (!before) {
        if (event.pointerType === 'mouse' || event.pointerType === 'pen') point(now);
        return;
      }
      if (pointers.size === 1) {
        viewer.viewport.panBy(now.x - before.x, now.y - before.y);
      } else {
        pinch(viewer.viewport, before, now, [...pointers].find(([id]) => id !== event.pointerId)[1]);
      }
      moved += Math.hypot(now.x - before.x, now.y - before.y);
      pointers.set(event.pointerId, now);
      viewer.viewChanged();
    },
    pointerup(event) {
      const wasDown = pointers.delete(event.pointerId);
      if (pointers.size === 0) element.classList.remove('is-dragged');
      if (wasDown && moved < kTapPx && pointers.size === 0) point(at(event));
    },
    pointercancel(event) {
      pointers.delete(event.pointerId);
      element.classList.remove('is-dragged');
    },
    pointerleave(event) {
      if (event.pointerType === 'mouse' && pointers.size === 0) viewer.setCursor(null);
    },
    wheel(event) {
      event.preventDefault();
      const {x, y} = at(event);
      const lines = event.deltaMode === 1 ? 33 : 1;
      const strength = event.ctrlKey ? 5 : 1;
      viewer.viewport.zoomAt(kWheelZoom ** (-event.deltaY * lines * strength), x, y);
      viewer.viewChanged();
      point({x, y});
    },
    dblclick(event) {
      const {x, y} = at(event);
      if (viewer.viewport.isFit) viewer.viewport.zoomTo(Math.max(1, 2 * viewer.viewport.zoom), x, y);
      else viewer.viewport.fit();
      viewer.viewChanged();
    },
  };
  for (const [type, handler] of Object.entries(handlers))
    element.addEventListener(type, handler, {passive: false});
  return () => {
    for (const [type, handler] of Object.entries(handlers)) element.removeEventListener(type, handler);
  };
}

// One of two fingers moves from `before` to `now`; the other is at `still`.
function pinch(viewport, before, now, still) {
  const distance = (a, b) => Math.max(10, Math.hypot(a.x - b.x, a.y - b.y));
  viewport.panBy((now.x - before.x) / 2, (now.y - before.y) / 2);
  viewport.zoomAt(
    distance(now, still) / distance(before, still),
    (now.x + still.x) / 2,
    (now.y + still.y) / 2,
  );
}

// The keyboard's part, for shortcuts.js.
export function viewerKeys(viewer, {setExposure}) {
  const change = (f) => () => {
    f(viewer.viewport);
    viewer.viewChanged();
  };
  const pan = (key, dx, dy, shown = null) => ({
    key,
    shown,
    help: shown && 'Pan; with Shift, move the cursor by one pixel',
    run: (event) =>
      event.shiftKey
        ? moveCursor(-dx, -dy)
        : change((view) => view.panBy((dx * view.width) / 10, (dy * view.height) / 10))(),
  });
  const moveCursor = (dx, dy) => {
    const {viewport} = viewer;
    const from = viewer.cursor ?? {x: Math.floor(viewport.x), y: Math.floor(viewport.y)};
    const x = Math.max(0, Math.min(viewport.imageWidth - 1, from.x + dx));
    const y = Math.max(0, Math.min(viewport.imageHeight - 1, from.y + dy));
    viewport.reveal(x, y);
    viewer.setCursor({x, y}, true);
    viewer.listener.view();
  };
  return [
    pan('ArrowLeft', 1, 0, ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown']),
    pan('ArrowRight', -1, 0),
    pan('ArrowUp', 0, 1),
    pan('ArrowDown', 0, -1),
    {key: ['+', '='], shown: ['+'], help: 'Zoom in', run: change((view) => view.zoomAt(Math.SQRT2))},
    {key: ['-', '_'], shown: ['-'], help: 'Zoom out', run: change((view) => view.zoomAt(Math.SQRT1_2))},
    {key: '0', help: 'Fit the image', run: change((view) => view.fit())},
    {key: '1', help: 'One pixel is one pixel', run: change((view) => view.zoomTo(1 / view.ratio))},
    {key: '2', help: 'Values in the pixels', run: change((view) => view.zoomTo(72))},
    {key: 'e', help: 'Exposure up', run: () => setExposure(viewer.display.exposure + 0.25)},
    {key: 'd', help: 'Exposure down', run: () => setExposure(viewer.display.exposure - 0.25)},
  ];
}
