#!/usr/bin/env python3
"""Values of a robot with a floating base and ball joints by Drake and by MuJoCo, each in its own layout, as JSON on stdout.

    pip install drake mujoco            # 1.51.1 and 4.0.0, Python 3.11 or later
    python make_layouts.py layouts.toml > layouts.json

The description is read here a second time. Drake's base is a QuaternionFloatingJoint and its balls are BallRpyJoints, MuJoCo's are
a free joint and balls. Values (SI, rad) of each program: its positions q, velocities v and accelerations a in the order of the
description's joints, what they call generalized forces (id, inverse dynamics without friction) and M.
"""
import importlib.metadata, json, sys, tomllib
import numpy as np

GRAVITY = [0, 0, -9.81]


def tree(text):
    """Joints with their kind, parent, origin and axis; the base floats."""
    yield dict(name=text["base"]["link"], kind="floating", parent=None, origin={}, axis=None)
    for joint in text["joints"]:
        yield dict(name=joint["name"], kind=joint.get("type", "revolute"), parent=joint["parent"], origin=joint["origin"], axis=joint.get("axis"))


def bodies(text): return {body["link"]: body for body in text["bodies"]}


def unit_quaternion(rng): x = rng.uniform(-1, 1, 4); return x / np.linalg.norm(x)


class Drake:
    def __init__(self, text):
        from pydrake.math import RigidTransform, RollPitchYaw
        from pydrake.multibody.plant import MultibodyPlant
        from pydrake.multibody.tree import BallRpyJoint, FixedOffsetFrame, QuaternionFloatingJoint, RevoluteJoint, RotationalInertia, SpatialInertia
        self.plant = plant = MultibodyPlant(0.0); plant.mutable_gravity_field().set_gravity_vector(GRAVITY)
        links, self.joints = {}, []
        for name, body in bodies(text).items():
            i = body["inertia"]; about_com = RotationalInertia(*(i[key] for key in ("xx", "yy", "zz", "xy", "xz", "yz")))
            links[name] = plant.AddRigidBody(name, SpatialInertia.MakeFromCentralInertia(body["mass"], np.array(body["center_of_mass"], float), about_com))
        for joint in tree(text):
            name = joint["name"]; parent = links[joint["parent"]] if joint["parent"] else plant.world_body(); origin = joint["origin"]
            pose = RigidTransform(RollPitchYaw(origin.get("rpy", [0, 0, 0])), origin.get("xyz", [0, 0, 0]))
            stand = plant.AddFrame(FixedOffsetFrame(name + "_stand", parent.body_frame(), pose)); frames = (name + "_joint", stand, links[name].body_frame())
            made = {"floating": lambda: QuaternionFloatingJoint(*frames), "spherical": lambda: BallRpyJoint(*frames), "revolute": lambda: RevoluteJoint(*frames, joint["axis"])}
            self.joints.append((joint["kind"], plant.AddJoint(made[joint["kind"]]())))
        plant.Finalize(); self.context = plant.CreateDefaultContext()
        starts = [joint.velocity_start() for _, joint in self.joints]; assert starts == sorted(starts), "another order"

    def positions(self, rng):
        one = {"floating": lambda: [*unit_quaternion(rng), *rng.uniform(-1, 1, 3)], "spherical": lambda: rng.uniform(-1.3, 1.3, 3), "revolute": lambda: rng.uniform(-2, 2, 1)}
        return np.concatenate([one[kind]() for kind, _ in self.joints])

    def velocities(self): return self.plant.num_velocities()

    def values(self, q, v, a):
        from pydrake.multibody.tree import MultibodyForces
        plant, context = self.plant, self.context; plant.SetPositions(context, q); plant.SetVelocities(context, v)
        forces = MultibodyForces(plant); plant.CalcForceElementsContribution(context, forces)
        return plant.CalcInverseDynamics(context, a, forces), plant.CalcMassMatrix(context)


class MuJoCo:
    def __init__(self, text):
        import mujoco; self.mujoco = mujoco; self.kinds = [joint["kind"] for joint in tree(text)]
        numbers = lambda entries: " ".join(map(repr, map(float, entries)))
        def turn(rpy):
            r, p, y = (np.array([[np.cos(x / 2), np.sin(x / 2)] for x in rpy]))
            (cr, sr), (cp, sp), (cy, sy) = r, p, y
            return [cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy]
        def nested(parent):
            for joint in tree(text):
                if joint["parent"] != parent: continue
                name, origin = joint["name"], joint["origin"]; body = bodies(text)[name]; i = body["inertia"]
                moving = {"floating": "<freejoint/>", "spherical": '<joint type="ball"/>'}.get(joint["kind"]) or f'<joint type="hinge" axis="{numbers(joint["axis"])}"/>'
                inertial = f'<inertial pos="{numbers(body["center_of_mass"])}" mass="{body["mass"]!r}" fullinertia="{numbers(i[key] for key in ("xx", "yy", "zz", "xy", "xz", "yz"))}"/>'
                yield f'<body pos="{numbers(origin.get("xyz", [0, 0, 0]))}" quat="{numbers(turn(origin.get("rpy", [0, 0, 0])))}">{moving}{inertial}{"".join(nested(name))}</body>'
        gravity = numbers(GRAVITY); compiler = '<compiler angle="radian" boundmass="0" boundinertia="0"/>'
        self.model = mujoco.MjModel.from_xml_string(f'<mujoco>{compiler}<option gravity="{gravity}"/><worldbody>{"".join(nested(None))}</worldbody></mujoco>')
        self.data = mujoco.MjData(self.model)

    def positions(self, rng):
        one = {"floating": lambda: [*rng.uniform(-1, 1, 3), *unit_quaternion(rng)], "spherical": lambda: unit_quaternion(rng), "revolute": lambda: rng.uniform(-2, 2, 1)}
        return np.concatenate([one[kind]() for kind in self.kinds])

    def velocities(self): return self.model.nv

    def values(self, q, v, a):
        mujoco, model, data = self.mujoco, self.model, self.data; data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data); mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, mass, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, mass)
        return data.qfrc_inverse.copy(), mass


def main():
    with open(sys.argv[1], "rb") as file: text = tomllib.load(file)
    programs = {}
    for kind in (Drake, MuJoCo):
        robot, rng, samples, package = kind(text), np.random.default_rng(13), [], kind.__name__.lower()
        for _ in range(3):
            q = robot.positions(rng); v, a = (rng.uniform(-size, size, robot.velocities()) for size in (2, 5))
            tau, mass = robot.values(q, v, a); samples.append(dict(q=q.tolist(), v=v.tolist(), a=a.tolist(), id=tau.tolist(), M=mass.tolist()))
        programs[package] = dict(version=importlib.metadata.version(package), samples=samples)
    json.dump(programs, sys.stdout); print()


main()
