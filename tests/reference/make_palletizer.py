#!/usr/bin/env python3
"""Accelerations of models/palletizer.toml by Pinocchio's proximal solver of closed loops, as JSON on stdout.

    pip install pin numpy            # 4.1.0, Python 3.11 or later
    python make_palletizer.py ../../models/palletizer.toml > palletizer.json

What follows in the description is free here: crank, rod and forearm turn by themselves, the level tool carrier slides in the
turret's plane, and two loops are closed by points that coincide (rod and forearm, forearm and carrier). The constraints hold at
positions and velocities; the solver finds accelerations. Rotors are entries of the diagonal. Values (SI, rad): y, v, the
inputs u, fd, the accelerations of turret, lower arm, crank and tool, and residual, the largest acceleration between the points.
"""
import json, sys, tomllib
import numpy as np
import pinocchio as pin

LENGTH, REACH, SHORT = 0.9, 1.0, 0.3  # lower arm, forearm, crank: checked against the description below


def turn(angle): return pin.utils.rotate("y", angle)
def place(*xyz): return pin.SE3(np.eye(3), np.array(xyz, float))


def inertia(body):
    moments = body["inertia"] if isinstance(body["inertia"], list) else [body["inertia"]] * 3
    return pin.Inertia(body["mass"], np.array(body["center_of_mass"], float), np.diag(np.array(moments, float)))


class Palletizer:
    def __init__(self, text):
        joints = {joint["name"]: joint for joint in text["joints"]}; bodies = {body["link"]: inertia(body) for body in text["bodies"]}
        origin = lambda name: joints[name].get("origin", {}).get("xyz", [0, 0, 0])
        assert origin("forearm") == [0, 0, LENGTH] and origin("rod") == [-SHORT, 0, 0] and origin("level") == [REACH, 0, 0]
        assert joints["level"]["follows"] == {"crank": -1} and joints["rod"]["follows"] == {"lower_arm": 1, "crank": -1} and joints["forearm"]["follows"] == {"crank": 1, "lower_arm": -1}
        self.model = model = pin.Model(); self.index = {}; self.pivot = np.array(origin("lower_arm"), float)
        def add(name, parent, kind, at, body=None):
            self.index[name] = i = model.addJoint(self.index.get(parent, 0), kind, place(*at), name)
            if body: model.appendBodyToJoint(i, bodies[body], pin.SE3.Identity())
        add("turret", None, pin.JointModelRZ(), origin("turret"), "turret")
        add("lower_arm", "turret", pin.JointModelRY(), self.pivot, "lower_arm")
        add("forearm", "lower_arm", pin.JointModelRY(), origin("forearm"), "forearm")
        add("crank", "turret", pin.JointModelRY(), origin("crank"), "crank")
        add("rod", "crank", pin.JointModelRY(), origin("rod"), "rod")
        add("level_x", "turret", pin.JointModelPX(), [0, 0, 0]); add("level_z", "level_x", pin.JointModelPZ(), [0, 0, 0], "level")
        add("tool", "level_z", pin.JointModelRZ(), origin("tool"), "tool")
        self.own = [model.joints[self.index[name]].idx_v for name in ("turret", "lower_arm", "crank", "tool")]
        drives = [joints[name] for name in ("turret", "lower_arm", "crank", "tool")]
        self.ratios = np.array([drive["drive"]["gear_ratio"] for drive in drives], float); self.friction = [drive["friction"] for drive in drives]
        armature = np.zeros(model.nv); armature[self.own] = [r * r * drive["drive"]["rotor_inertia"] for r, drive in zip(self.ratios, drives)]; model.armature = armature
        meet = lambda a, at_a, b, at_b: pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, self.index[a], place(*at_a), self.index[b], place(*at_b), pin.ReferenceFrame.LOCAL)
        self.loops = [meet("rod", [0, 0, LENGTH], "forearm", [-SHORT, 0, 0]), meet("forearm", [REACH, 0, 0], "level_z", [0, 0, 0])]

    def positions(self, y):
        wrist = self.pivot + turn(y[1]) @ [0, 0, LENGTH] + turn(y[2]) @ [REACH, 0, 0]
        return self.ordered(dict(turret=y[0], lower_arm=y[1], forearm=y[2] - y[1], crank=y[2], rod=y[1] - y[2], level_x=wrist[0], level_z=wrist[2], tool=y[3]))

    def velocities(self, y, v):
        rate = lambda angle, arm: np.cross([0, 1.0, 0], turn(angle) @ arm)
        wrist = v[1] * rate(y[1], [0, 0, LENGTH]) + v[2] * rate(y[2], [REACH, 0, 0])
        return self.ordered(dict(turret=v[0], lower_arm=v[1], forearm=v[2] - v[1], crank=v[2], rod=v[1] - v[2], level_x=wrist[0], level_z=wrist[2], tool=v[3]))

    def ordered(self, values):
        x = np.zeros(self.model.nv)
        for name, value in values.items(): x[self.model.joints[self.index[name]].idx_v] = value
        return x

    def rubbing(self, v):
        return np.array([f["viscous"] * x + (f["coulomb"]["value"] * np.tanh(f["coulomb"]["slope"] * x) if "coulomb" in f else 0) for f, x in zip(self.friction, v)])

    def accelerations(self, y, v, u):
        model, q, qd = self.model, self.positions(y), self.velocities(y, v); data = model.createData(); of_loops = pin.StdVec_RigidConstraintModel(self.loops), pin.StdVec_RigidConstraintData([loop.createData() for loop in self.loops])
        tau = np.zeros(model.nv); tau[self.own] = self.ratios * u - self.rubbing(v)
        pin.initConstraintDynamics(model, data, *of_loops)
        found = pin.constraintDynamics(model, data, q, qd, tau, *of_loops, pin.ProximalSettings(1e-14, 1e-10, 100)).copy()
        return found, self.residual(q, qd, found)

    def residual(self, q, qd, acceleration):
        """The largest distance, speed and acceleration between points that shall coincide."""
        model, data = self.model, self.model.createData(); pin.forwardKinematics(model, data, q, qd, acceleration); worst = []
        for loop in self.loops:
            ends = [(data.oMi[i], data.v[i], data.a[i], at.translation) for i, at in ((loop.joint1_id, loop.joint1_placement), (loop.joint2_id, loop.joint2_placement))]
            def point(M, v, a, r):
                speed = v.linear + np.cross(v.angular, r); rate = a.linear + np.cross(a.angular, r) + np.cross(v.angular, speed)
                return M.act(r), M.rotation @ speed, M.rotation @ rate
            worst += [np.abs(one - other).max() for one, other in zip(point(*ends[0]), point(*ends[1]))]
        return max(worst)


def main():
    with open(sys.argv[1], "rb") as file: robot = Palletizer(tomllib.load(file))
    rng, samples = np.random.default_rng(5), []
    for _ in range(4):
        y, v, u = rng.uniform([-2, -.5, -.2, -3], [2, 1.2, 1.6, 3]), rng.uniform(-1.5, 1.5, 4), rng.uniform(-1, 1, 4) * [10, 12, 10, 1]
        found, residual = robot.accelerations(y, v, u); assert residual < 1e-9, residual
        samples.append(dict(y=y.tolist(), v=v.tolist(), u=u.tolist(), fd=found[robot.own].tolist(), residual=residual))
    json.dump(dict(made_by=f"pinocchio {pin.__version__}", samples=samples), sys.stdout); print()


main()
