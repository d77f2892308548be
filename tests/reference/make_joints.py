#!/usr/bin/env python3
"""Values of robots with helical, cylindrical, universal and planar joints by Pinocchio, as JSON on stdout.

    pip install pin numpy            # Python 3.11 or later
    python make_joints.py joints.toml > joints.json

The description is read here a second time. Every joint, every joint that follows others and every rotor becomes a joint of a
model of Pinocchio, whose positions are G y + g0; all values are Gᵀ (…) G. A rotor is a body with axial inertia alone.
The parts of composite joints are joints of their own; where no joint follows others, inverse dynamics and mass matrix
are checked against Pinocchio's own planar and universal joints, whose planar velocity is in the frame of the body.
Values (SI, rad): y, v, a, the inputs u, tau = B u; M, nle, g (the torques that hold the robot still), id, fd; did_dy, did_dv, dfd_dy, dfd_dv;
p, R, J (linear part first, in base axes, at the frame's origin) of the frame `last`; kinetic; reactions: for each moving
joint (those that follow stand last) force and moment about the joint's origin, in its frame after its motion.
"""
import json, sys, tomllib
import numpy as np
import pinocchio as pin

PARTS = {
    "cylindrical": [("turn", "revolute", 2), ("slide", "prismatic", 2)],
    "universal": [("x", "revolute", 0), ("y", "revolute", 1)],
    "planar": [("x", "prismatic", 0), ("y", "prismatic", 1), ("theta", "revolute", 2)],
}


def pose(origin):
    roll, pitch, yaw = origin.get("rpy", [0, 0, 0])
    return pin.SE3(pin.rpy.rpyToMatrix(roll, pitch, yaw), np.array(origin.get("xyz", [0, 0, 0]), float))


def shortest(axis):
    """The shortest rotation of z to an axis."""
    return pin.Quaternion.FromTwoVectors(np.array([0, 0, 1.0]), np.array(axis, float)).toRotationMatrix()


def joint_model(kind, axis, pitch=None):
    axis = np.array(axis, float)
    return {"revolute": pin.JointModelRevoluteUnaligned, "prismatic": pin.JointModelPrismaticUnaligned}[kind](axis) \
        if kind != "helical" else pin.JointModelHelicalUnaligned(axis, pitch)


class Robot:
    """Nodes are joints and rotors with their bodies; links are a node and a pose in it. Pinocchio's algorithms take joints
    depth first alone, so that its model is made when all nodes are known."""

    def __init__(self, text, native=False, rotors=True):
        self.text, self.nodes, self.links, self.follows = text, [], {"base": (None, pin.SE3.Identity())}, {}
        before = "base"
        for joint in text["joints"]:
            self.add(joint, joint.get("parent", before), native); before = joint["name"]
        self.names = [node["name"] for node in self.nodes]
        self.own = [name for name in self.names if name not in self.follows]
        for body in text["bodies"]:
            i = body["inertia"]; I = np.array([[i["xx"], i["xy"], i["xz"]], [i["xy"], i["yy"], i["yz"]], [i["xz"], i["yz"], i["zz"]]])
            node, place = self.links[body["link"]]
            self.nodes[node]["bodies"].append((pin.Inertia(body["mass"], np.array(body["center_of_mass"], float), I), place))
        rows = [] if native else [self.row(name) for name in self.names]
        if rotors: rows += self.rotors()
        self.build(rows)

    def node(self, name, parent, place, joint, axis=None):
        self.nodes.append(dict(name=name, parent=parent, place=place, joint=joint, axis=axis, bodies=[])); return len(self.nodes) - 1

    def add(self, joint, parent, native):
        kind, name, origin = joint.get("type", "revolute"), joint["name"], pose(joint.get("origin", {}))
        parent, place = self.links[parent]; place = place * origin; axis = joint.get("axis", [0, 0, 1])
        if kind == "fixed": self.links[name] = (parent, place); return
        if kind not in PARTS:
            if "follows" in joint: self.follows[name] = (joint["follows"], joint.get("offset", 0.0))
            self.links[name] = (self.node(name, parent, place, joint_model(kind, axis, joint.get("pitch")), axis), pin.SE3.Identity()); return
        turned = shortest(axis)
        if native and kind != "cylindrical":
            tilt = pin.SE3(turned, np.zeros(3)); own = {"planar": pin.JointModelPlanar(), "universal": pin.JointModelUniversal(np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))}[kind]
            self.links[name] = (self.node(name, parent, place * tilt, own), tilt.inverse()); return
        for part, part_kind, column in PARTS[kind]:
            parent = self.node(f"{name}_{part}", parent, place, joint_model(part_kind, turned[:, column]), turned[:, column]); place = pin.SE3.Identity()
        self.links[name] = (parent, place)

    def row(self, name):
        """Of G and g0."""
        if name not in self.follows: return np.eye(len(self.own))[self.own.index(name)], 0.0
        terms, offset = self.follows[name]; parts = [(ratio, *self.row(other)) for other, ratio in terms.items()]
        return sum(r * g for r, g, _ in parts), offset + sum(r * o for r, _, o in parts)

    def rotors(self):
        drives, self.B = [], []
        for joint in self.text["joints"]:
            drive, parts = joint.get("drive"), PARTS.get(joint.get("type"))
            of = [("", drive)] if parts is None else [("_" + p, drive if isinstance(drive, str) else (drive or {}).get(p)) for p, _, _ in parts]
            for suffix, motor in of:
                if motor == "ideal": motor = {}
                if motor is not None: drives.append(({joint["name"] + suffix: 1}, motor, joint["name"] + suffix))
        for drive in self.text.get("drives", []): drives.append((drive["on"], drive, drive["name"]))
        for on, motor, name in drives:
            turn = motor.get("gear_ratio", 1.0) * sum(r * self.row(other)[0] for other, r in on.items()); self.B.append(turn)
            if "carrier" in motor: (parent, place), axis = self.links[motor["carrier"]], motor["axis"]
            else: driven = self.nodes[self.names.index(name)]; parent, place, axis = driven["parent"], driven["place"], driven["axis"]  # on the parent of the joint, about its axis
            rotor = self.node("rotor " + name, parent, place, joint_model("revolute", axis))
            self.nodes[rotor]["bodies"].append((pin.Inertia(0.0, np.zeros(3), motor.get("rotor_inertia", 0.0) * np.outer(axis, axis)), pin.SE3.Identity()))
            yield turn, 0.0

    def build(self, rows):
        self.model, self.index = pin.Model(), {None: 0}
        self.model.gravity.linear = np.array(self.text.get("gravity", [0, 0, -9.81]), float)
        def visit(parent):
            for k, node in enumerate(self.nodes):
                if node["parent"] != parent: continue
                self.index[k] = i = self.model.addJoint(self.index[parent], node["joint"], node["place"], node["name"])
                for inertia, place in node["bodies"]: self.model.appendBodyToJoint(i, inertia, place)
                visit(k)
        visit(None)
        if not rows: return
        self.B = np.array(getattr(self, "B", [])).T; order = sorted(range(len(rows)), key=lambda k: self.index[k])
        self.G = np.array([rows[k][0] for k in order]); self.g0 = np.array([rows[k][1] for k in order])
        moving = self.own + list(self.follows); self.order = [self.index[self.names.index(name)] for name in moving]

    def values(self, y, v, a, tau):
        model, data, G = self.model, self.model.createData(), self.G
        q, qd, qdd = G @ y + self.g0, G @ v, G @ a
        M = np.triu(pin.crba(model, data, q)); M = G.T @ (M + np.triu(M, 1).T) @ G
        nle = G.T @ pin.nonLinearEffects(model, data, q, qd); g = G.T @ pin.computeGeneralizedGravity(model, data, q); fd = np.linalg.solve(M, tau - nle)
        tau_id = G.T @ pin.rnea(model, data, q, qd, qdd); reactions = [np.r_[data.f[k].linear, data.f[k].angular].tolist() for k in self.order]
        def derivatives(acceleration):
            by_q, by_v, _ = pin.computeRNEADerivatives(model, data, q, qd, acceleration); return G.T @ by_q @ G, G.T @ by_v @ G
        did_dy, did_dv = derivatives(qdd); at_fd = derivatives(G @ fd)
        s = dict(y=y, v=v, a=a, tau=tau, M=M, nle=nle, g=g, id=tau_id, fd=fd, did_dy=did_dy, did_dv=did_dv,
                 dfd_dy=-np.linalg.solve(M, at_fd[0]), dfd_dv=-np.linalg.solve(M, at_fd[1]), kinetic=pin.computeKineticEnergy(model, data, q, qd))
        node, place = self.links[next(f["link"] for f in self.text["frames"] if f["name"] == "last")]
        frame = model.addFrame(pin.Frame("last", self.index[node], place, pin.FrameType.OP_FRAME)) if not model.existFrame("last") else model.getFrameId("last")
        data = model.createData(); pin.forwardKinematics(model, data, q); M_frame = pin.updateFramePlacement(model, data, frame)
        s.update(p=M_frame.translation.copy(), R=M_frame.rotation.copy(), J=pin.computeFrameJacobian(model, data, q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED) @ G)
        return {k: x.tolist() if isinstance(x, np.ndarray) else x for k, x in s.items()} | dict(reactions=reactions)


def check_native(text, s):
    """M and the inverse dynamics, rotors taken away, by Pinocchio's own planar and universal joints."""
    native, bare = Robot(text, native=True, rotors=False), Robot(text, rotors=False)
    n = len(bare.names); q, T, Td = np.zeros(native.model.nq), np.zeros((n, n)), np.zeros((n, n))
    y, v, a = (np.array(s[k]) for k in "yva"); at = 0
    for k, node in enumerate(native.nodes):
        joint = native.model.joints[native.index[k]]; width = joint.nv; rows, mine = slice(joint.idx_v, joint.idx_v + width), slice(at, at + width)
        if joint.shortname() == "JointModelPlanar":
            c, si = np.cos(y[at + 2]), np.sin(y[at + 2]); q[joint.idx_q:joint.idx_q + 4] = y[at], y[at + 1], c, si
            T[rows, mine] = [[c, si, 0], [-si, c, 0], [0, 0, 1]]; Td[rows, mine] = v[at + 2] * np.array([[-si, c, 0], [-c, -si, 0], [0, 0, 0]])
        else: q[joint.idx_q:joint.idx_q + width] = y[mine]; T[rows, mine] = np.eye(width)
        at += width
    data = native.model.createData(); b = bare.values(y, v, a, np.zeros(n))
    tau = T.T @ pin.rnea(native.model, data, q, T @ v, T @ a + Td @ v); M = np.triu(pin.crba(native.model, data, q)); M = T.T @ (M + np.triu(M, 1).T) @ T
    for mine, theirs in ((b["id"], tau), (b["M"], M)): assert np.abs(np.array(mine) - theirs).max() < 1e-12 * np.abs(theirs).max(), "composite joints differ"


def check_columns(robot, s):
    """M by the inverse dynamics alone, and the derivatives by differences: Pinocchio is silently wrong where joints are not depth first."""
    y, v, a = (np.array(s[k]) for k in "yva"); n = len(y); f = lambda y, v, a: robot.G.T @ pin.rnea(robot.model, robot.model.createData(), robot.G @ y + robot.g0, robot.G @ v, robot.G @ a)
    e = np.eye(n); M = np.array([f(y, v, x) - f(y, v, 0 * x) for x in e]).T; h = 1e-6
    by_y, by_v = (np.array([(f(*up) - f(*down)) / (2 * h) for up, down in pairs]).T for pairs in ([((y + h * x, v, a), (y - h * x, v, a)) for x in e], [((y, v + h * x, a), (y, v - h * x, a)) for x in e]))
    for key, found, tolerance in (("M", M, 1e-12), ("did_dy", by_y, 1e-7), ("did_dv", by_v, 1e-7)): assert np.abs(s[key] - found).max() < tolerance * np.abs(found).max(), key


def main():
    with open(sys.argv[1], "rb") as file: text = tomllib.load(file)
    robot, rng, samples = Robot(text), np.random.default_rng(7), []
    n = robot.G.shape[1]
    for _ in range(2):
        s = robot.values(rng.uniform(-1.5, 1.5, n), rng.uniform(-2, 2, n), rng.uniform(-5, 5, n), robot.B @ (u := rng.uniform(-2, 2, robot.B.shape[1]))); samples.append(s | dict(u=u.tolist()))
        check_columns(robot, s)
        if not robot.follows: check_native(text, s)
    json.dump(dict(joints=[name for name in robot.names if name not in robot.follows], samples=samples), sys.stdout, indent=None); print()


main()
