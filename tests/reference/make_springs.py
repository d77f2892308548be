#!/usr/bin/env python3
"""Values of a robot with Drake's LinearSpringDamper between points, as JSON on stdout.

    pip install drake            # 1.51.1, Python 3.11 or later
    python make_springs.py springs.toml > springs.json

The description is read here a second time; a law is `k*(l - l0) + c*dl`. Values (SI, rad): y, v, a, u; id, what the drives
exert in the motion (springs and gravity act beside them), fd, the accelerations under u, V, the potential energy of gravity
and springs together, and springs, what the springs alone add to the right side of the equations.
"""
import importlib.metadata, json, re, sys, tomllib
import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (FixedOffsetFrame, LinearSpringDamper, MultibodyForces, PrismaticJoint, RevoluteJoint,
                                    RotationalInertia, SpatialInertia)

LAW = re.compile(r"([\d.]+)\*\(l - ([\d.]+)\) \+ ([\d.]+)\*dl")


def pose(origin): return RigidTransform(RollPitchYaw(origin.get("rpy", [0, 0, 0])), origin.get("xyz", [0, 0, 0]))


def spatial_inertia(body):
    m, c, i = body["mass"], np.array(body["center_of_mass"], float), body["inertia"]
    about_com = RotationalInertia(i["xx"], i["yy"], i["zz"], i["xy"], i["xz"], i["yz"])
    return SpatialInertia.MakeFromCentralInertia(m, c, about_com)


class Robot:
    def __init__(self, text, with_springs):
        self.plant = plant = MultibodyPlant(0.0)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -9.81])
        links = {"base": plant.world_body()} | {body["link"]: plant.AddRigidBody(body["link"], spatial_inertia(body)) for body in text["bodies"]}
        before, self.joints = "base", []
        for joint in text["joints"]:
            name = joint["name"]; kind = PrismaticJoint if joint.get("type") == "prismatic" else RevoluteJoint
            stand = plant.AddFrame(FixedOffsetFrame(name + "_stand", links[before].body_frame(), pose(joint["origin"])))
            self.joints.append(plant.AddJoint(kind(name + "_joint", stand, links[name].body_frame(), joint["axis"]))); before = name
        at = {frame["name"]: (links[frame["link"]], frame["origin"]["xyz"]) for frame in text["frames"]}
        for force in text["forces"] if with_springs else []:
            stiffness, rest, damping = (float(x) for x in LAW.fullmatch(force["law"]).groups())
            (a, p), (b, q) = (at[name] for name in force["between"])
            plant.AddForceElement(LinearSpringDamper(a, p, b, q, rest, stiffness, damping))
        plant.Finalize(); self.context = plant.CreateDefaultContext()
        assert [joint.velocity_start() for joint in self.joints] == list(range(len(self.joints))), "another order"

    def set(self, y, v): self.plant.SetPositions(self.context, y); self.plant.SetVelocities(self.context, v)

    def inverse_dynamics(self, a):
        forces = MultibodyForces(self.plant); self.plant.CalcForceElementsContribution(self.context, forces)
        return self.plant.CalcInverseDynamics(self.context, a, forces)

    def forward_dynamics(self, u):
        self.plant.get_applied_generalized_force_input_port().FixValue(self.context, u)
        return self.plant.get_generalized_acceleration_output_port(self.plant.GetJointByName(self.joints[0].name()).model_instance()).Eval(self.context)


def main():
    with open(sys.argv[1], "rb") as file: text = tomllib.load(file)
    robot, bare, rng, samples = Robot(text, True), Robot(text, False), np.random.default_rng(11), []
    for _ in range(4):
        y, v, a, u = rng.uniform(-1.2, 1.2, 4), rng.uniform(-2, 2, 4), rng.uniform(-5, 5, 4), rng.uniform(-40, 40, 4)
        for each in (robot, bare): each.set(y, v)
        tau = robot.inverse_dynamics(a)
        samples.append(dict(y=y, v=v, a=a, u=u, id=tau, fd=robot.forward_dynamics(u), V=robot.plant.EvalPotentialEnergy(robot.context), springs=bare.inverse_dynamics(a) - tau))
    samples = [{key: np.asarray(value).tolist() for key, value in sample.items()} for sample in samples]
    json.dump(dict(made_by=f"drake {importlib.metadata.version('drake')}", samples=samples), sys.stdout); print()


main()
