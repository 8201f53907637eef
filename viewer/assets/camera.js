// Draws what the camera saw last: the picture itself where it was kept, else the circles as they were; where the circles are and
// where the vision found them.
"use strict";
acro.circles = ["drum", "joint", "tip"];

// The picture of a frame, decoded once; null where there is none.
acro.kept = function (run, number, redraw) {
  if (!run.pictures) run.pictures = new Map(run.frames.map((frame) => [frame.number, frame.png]));
  const known = run.pictures.get(number);
  if (known == null) return null;
  if (typeof known !== "string") return known.complete && known.naturalWidth > 0 ? known : null;
  const image = new Image();
  image.onload = redraw;
  image.src = "data:image/png;base64," + known;
  run.pictures.set(number, image);
  return null;
};

// Ideal places of the circles in pixels, u right and v up from the centre, at the pose of mid-exposure.
acro.ideal = function (run, middle) {
  const seen = "seen_q1" in run.parts && "seen_q2" in run.parts ? "seen_" : "";
  const [q1, q2] = [run.at(seen + "q1", middle), run.at(seen + "q2", middle)];
  if (q1 == null || q2 == null) return null;
  const scene = run.machine.scene;
  return acro.pose(scene, q1, q2).map(([x, y]) => [x * scene.width / scene.field_of_view, y * scene.width / scene.field_of_view]);
};

acro.drawCamera = function (canvas, caption, run, row, redraw) {
  const [pen, side] = acro.sharp(canvas);
  const scene = run.machine.scene;
  const part = (name) => run.part(name, row);
  pen.fillStyle = "#000";
  pen.fillRect(0, 0, side, side);
  const number = part("frame_index");
  if (number == null || number < 0) {
    caption.textContent = "No picture has come yet.";
    return;
  }
  const pixel = side / Math.max(scene.width, scene.height);
  const place = ([u, v]) => [(scene.width / 2 + u) * pixel, (scene.height / 2 - v) * pixel];
  const truth = acro.ideal(run, part("t_mid"));
  const image = acro.kept(run, number, redraw);
  if (image) pen.drawImage(image, 0, 0, scene.width * pixel, scene.height * pixel);
  else if (truth) acro.drawDiscs(pen, truth.map(place), scene.radius * scene.width / scene.field_of_view * pixel);
  const seen = part("valid") !== 0;
  const found = acro.circles.map((_, index) => [part("u" + (index + 1)), part("v" + (index + 1))]);
  pen.font = "12px system-ui, sans-serif";
  if (truth) truth.forEach((at) => acro.ring(pen, place(at), "#56b4e9"));
  if (seen) found.forEach((at, index) => { if (at[0] != null) acro.cross(pen, place(at), "#f0a000", acro.circles[index]); });
  const apart = acro.circles.map((name, index) => (truth && seen && found[index][0] != null ? `${name} ${Math.hypot(found[index][0] - truth[index][0], found[index][1] - truth[index][1]).toFixed(2)}` : null));
  const words = seen ? `Orange: found; blue: an ideal lens. Apart: ${apart.filter(Boolean).join(", ")} px.` : "Not all three circles were found.";
  caption.textContent = `Frame ${number}, ${image ? "the picture itself" : "drawn, no picture of it was found"}. ${words}`;
};

acro.drawDiscs = function (pen, places, radius) {
  pen.fillStyle = "#fff";
  for (const [x, y] of places) { pen.beginPath(); pen.arc(x, y, Math.max(2, radius), 0, 2 * Math.PI); pen.fill(); }
};

acro.ring = function (pen, [x, y], colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.arc(x, y, 9, 0, 2 * Math.PI);
  pen.stroke();
};

acro.cross = function (pen, [x, y], colour, name) {
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x - 13, y);
  pen.lineTo(x + 13, y);
  pen.moveTo(x, y - 13);
  pen.lineTo(x, y + 13);
  pen.stroke();
  pen.fillText(name, x + 16, y - 6);
};
