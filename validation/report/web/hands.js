// Mouse, fingers and keys on the 3D view. The page must stay scrollable: until the view was tapped, a finger that moves
// up or down scrolls the page and the wheel is left alone; two fingers always zoom and move.

function addHands(viewer, onPick) {
  const { canvas, root } = viewer;
  const pointers = new Map();
  let travelled = 0;

  function activate(isActive) {
    root.classList.toggle("active", isActive);
  }
  document.addEventListener("pointerdown", (event) => {
    if (!root.contains(event.target)) activate(false);
  });

  function moveTwo(id, before, now) {
    const other = [...pointers].find(([key]) => key !== id)[1];
    const span = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
    viewer.zoomBy(span(now) / Math.max(1, span(before)));
    viewer.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
  }
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    if (!pointers.size) travelled = 0;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY], dx = now[0] - before[0], dy = now[1] - before[1];
    travelled += Math.hypot(dx, dy);
    if (pointers.size === 2) moveTwo(event.pointerId, before, now);
    else if (event.shiftKey || event.buttons === 4 || event.buttons === 2) viewer.pan(dx, dy);
    else viewer.turn(dx * 0.008, dy * 0.008);
    pointers.set(event.pointerId, now);
  });
  canvas.addEventListener("pointerup", (event) => {
    const isTap = pointers.size === 1 && travelled < 5 && event.button === 0;
    pointers.delete(event.pointerId);
    if (!isTap) return;
    activate(true);
    onPick(viewer.pickAt(event.clientX, event.clientY));
  });
  canvas.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    if (!root.classList.contains("active") && !event.ctrlKey) return;
    event.preventDefault();
    viewer.zoomBy(Math.exp(-event.deltaY * 0.0012));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    if (steps[event.key]) viewer.turn(...steps[event.key]);
    else if (event.key === "+") viewer.zoomBy(1.15);
    else if (event.key === "-") viewer.zoomBy(1 / 1.15);
    else return;
    event.preventDefault();
  });
}
