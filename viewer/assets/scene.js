// Draws the acrobot in the plane: ground, drum, links, torque, the equilibrium that is wished, and the place on the manifold.
"use strict";

// Where drum, joint and tip are in world units, as in fmus/camera/src/scene.rs.
acro.pose = function (scene, q1, q2) {
  const drum = [scene.R * q1, scene.ground + scene.R];
  const joint = [drum[0] + scene.l1 * Math.sin(q1), drum[1] + scene.l1 * Math.cos(q1)];
  return [drum, joint, [joint[0] + scene.l2 * Math.sin(q2), joint[1] + scene.l2 * Math.cos(q2)]];
};

// q1 and q2 of the equilibrium at a place on the manifold; its end for a place beyond it.
acro.equilibrium = function (manifold, z) {
  if (!manifold.length || z == null) return null;
  if (z <= manifold[0][0]) return manifold[0].slice(1);
  for (let i = 1; i < manifold.length; i++) {
    if (z > manifold[i][0]) continue;
    const [a, b] = [manifold[i - 1], manifold[i]];
    const share = (z - a[0]) / (b[0] - a[0]);
    return [a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])];
  }
  return manifold[manifold.length - 1].slice(1);
};

// A canvas as sharp as the screen; answers its context and its side in CSS pixels.
acro.sharp = function (canvas) {
  const side = canvas.clientWidth || 300;
  const pixels = Math.round(side * devicePixelRatio);
  if (canvas.width !== pixels) { canvas.width = pixels; canvas.height = pixels; }
  const context = canvas.getContext("2d");
  context.setTransform(pixels / side, 0, 0, pixels / side, 0, 0);
  context.clearRect(0, 0, side, side);
  return [context, side];
};

acro.drawScene = function (canvas, machine, at) {
  const [pen, side] = acro.sharp(canvas);
  const scene = machine.scene;
  const unit = side / scene.field_of_view;
  const place = ([x, y]) => [side / 2 + x * unit, side / 2 - y * unit];
  pen.font = "12px system-ui, sans-serif";
  acro.drawGround(pen, scene, side, unit, place);
  const goal = acro.equilibrium(machine.manifold, at.z_desired);
  if (goal) acro.drawArm(pen, scene, acro.pose(scene, ...goal).map(place), unit, { colour: acro.colour("line2"), dash: [5, 4], width: 1.5 });
  if (at.q1 == null || at.q2 == null) return;
  const points = acro.pose(scene, at.q1, at.q2).map(place);
  acro.drawArm(pen, scene, points, unit, { colour: acro.colour("ink"), dash: [], width: Math.max(3, 0.35 * unit), spokes: at.q1, fill: true });
  acro.drawTorque(pen, points[1], at, side);
  // Each name on the side to which no link goes.
  pen.fillStyle = acro.colour("soft");
  const leans = [points[1][0] - points[0][0], points[2][0] - points[1][0], points[1][0] - points[2][0]];
  const away = [scene.R * unit + 5, 27, 10];
  ["drum", "joint", "tip"].forEach((name, index) => {
    pen.textAlign = leans[index] > 0 ? "right" : "left";
    pen.fillText(name, points[index][0] + (leans[index] > 0 ? -away[index] : away[index]), points[index][1] + 4);
  });
  pen.textAlign = "left";
  if (machine.manifold.length) acro.drawPlace(pen, machine.manifold, side, at, goal);
};

acro.drawGround = function (pen, scene, side, unit, place) {
  const fall = Math.tan(scene.slope) * scene.field_of_view / 2;
  const [left, right] = [place([-scene.field_of_view / 2, scene.ground + fall]), place([scene.field_of_view / 2, scene.ground - fall])];
  pen.fillStyle = acro.colour("panel");
  pen.strokeStyle = acro.colour("soft");
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(...left);
  pen.lineTo(...right);
  pen.stroke();
  pen.lineTo(side, side);
  pen.lineTo(0, side);
  pen.fill();
};

acro.drawArm = function (pen, scene, [drum, joint, tip], unit, look) {
  pen.strokeStyle = look.colour;
  pen.setLineDash(look.dash);
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.arc(drum[0], drum[1], scene.R * unit, 0, 2 * Math.PI);
  pen.stroke();
  if (look.spokes != null) {
    for (let spoke = 0; spoke < 3; spoke++) {
      const angle = look.spokes + spoke * Math.PI / 3;
      const [x, y] = [scene.R * unit * Math.sin(angle), scene.R * unit * Math.cos(angle)];
      pen.beginPath();
      pen.moveTo(drum[0] - x, drum[1] + y);
      pen.lineTo(drum[0] + x, drum[1] - y);
      pen.stroke();
    }
  }
  pen.lineWidth = look.width;
  pen.lineCap = "round";
  pen.lineJoin = "round";
  pen.beginPath();
  pen.moveTo(...drum);
  pen.lineTo(...joint);
  pen.lineTo(...tip);
  pen.stroke();
  pen.setLineDash([]);
  if (!look.fill) return;
  pen.fillStyle = acro.colour("paper");
  pen.lineWidth = 1;
  for (const [x, y] of [drum, joint, tip]) {
    pen.beginPath();
    pen.arc(x, y, Math.max(3, scene.radius * unit), 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
  }
};

// The torque between the links as an arc around the joint: clockwise for a positive one, longer for a larger one.
acro.drawTorque = function (pen, [x, y], at, side) {
  if (at.torque == null) return;
  const share = at.largest > 0 ? Math.max(-1, Math.min(1, at.torque / at.largest)) : 0;
  pen.strokeStyle = pen.fillStyle = acro.colour("line1");
  pen.lineWidth = 2.5;
  if (Math.abs(share) > 0.01) {
    const [from, to, radius] = [-Math.PI / 2, -Math.PI / 2 + share * 1.5 * Math.PI, 22];
    pen.beginPath();
    pen.arc(x, y, radius, from, to, share < 0);
    pen.stroke();
    const [tipX, tipY, turn] = [x + radius * Math.cos(to), y + radius * Math.sin(to), to + (share > 0 ? Math.PI / 2 : -Math.PI / 2)];
    pen.beginPath();
    pen.moveTo(tipX + 8 * Math.cos(turn), tipY + 8 * Math.sin(turn));
    for (const aside of [2.5, -2.5]) pen.lineTo(tipX + 6 * Math.cos(turn + aside), tipY + 6 * Math.sin(turn + aside));
    pen.fill();
  }
  pen.textAlign = "right";
  pen.fillText(`τ = ${at.torque.toFixed(2)} N·m`, side - 8, 18);
  pen.textAlign = "left";
};

// The place on the manifold: the curve of equilibria in the plane of q2 and q1, where the arm is, and where it shall be.
acro.drawPlace = function (pen, manifold, side, at, goal) {
  const width = Math.min(120, side * 0.32);
  const height = width * 0.5;
  const [left, top] = [8, 8];
  const [q2, q1] = [manifold[manifold.length - 1][2], 0.9];
  const spot = (a1, a2) => [left + width / 2 * (1 + Math.max(-1, Math.min(1, a2 / q2))), top + height / 2 * (1 - Math.max(-1, Math.min(1, a1 / q1)))];
  pen.strokeStyle = acro.colour("rule");
  pen.lineWidth = 1;
  pen.strokeRect(left, top, width, height);
  pen.strokeStyle = acro.colour("line2");
  pen.beginPath();
  manifold.forEach(([, a1, a2], index) => (index ? pen.lineTo(...spot(a1, a2)) : pen.moveTo(...spot(a1, a2))));
  pen.stroke();
  const disc = (where, colour, radius) => { pen.fillStyle = acro.colour(colour); pen.beginPath(); pen.arc(...where, radius, 0, 2 * Math.PI); pen.fill(); };
  if (goal) disc(spot(...goal), "line2", 4);
  disc(spot(at.q1, at.q2), "line1", 3);
  pen.fillStyle = acro.colour("soft");
  pen.fillText(at.z == null ? "manifold" : `manifold, z = ${at.z.toFixed(3)}`, left, top + height + 14);
};
