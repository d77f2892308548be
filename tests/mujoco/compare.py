#!/usr/bin/env python3
"""Values of gelenk beside those of MuJoCo, and of Pinocchio where it is installed.

usage: compare.py VALUES.json      compares, and prints a line for each robot; exit code 1 where one differs
       compare.py --list           prints the files in MJCF of the installed packages, one in a line

VALUES.json is a list of robots with files and values at seeded states, as tests/src/mujoco.rs writes it. MuJoCo keeps joints
that follow others among its coordinates. With the rows G of its equalities, `q = G y + g`, the matrices of gelenk are
`M = Gᵀ M_mujoco G` and k = Gᵀ (bias + M_mujoco Ġ ẏ). Joints are found by their names, or (where a file names not all of them) by
their order. Velocities of a free joint are those of the body's own frame.
"""
import json
import os
import sys

import numpy as np

MOST = 1e-10
# Ten times the share of an acceleration that an equality with the impedance 0.9999 leaves.
MOST_OF = {"acceleration": 1e-3}
ROBOTS = ["dm_control", "gymnasium", "mujoco_menagerie", "robosuite"]


def relative(found, wanted):
    """The largest difference beside the largest entry."""
    found, wanted = np.asarray(found, float), np.asarray(wanted, float)
    if found.shape != wanted.shape:
        return np.inf
    size = max(np.abs(wanted).max(initial=0.0), np.abs(found).max(initial=0.0))
    difference = np.abs(found - wanted).max(initial=0.0)
    return difference if size < 1e-12 else difference / size if np.isfinite(size) else np.inf


def followers(mujoco, model, with_tendons):
    """For each joint that follows: its address, and its row `offset + Σ factor · q[address]`."""
    rows = {}
    address = model.jnt_qposadr
    for k in range(model.neq):
        first, second, data = model.eq_obj1id[k], model.eq_obj2id[k], model.eq_data[k]
        if not model.eq_active0[k]:
            continue
        if model.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT and not np.any(data[2:5]):
            one = address[first]
            offset = model.qpos0[one] + data[0]
            terms = []
            if second >= 0:
                terms = [(address[second], data[1])]
                offset -= data[1] * model.qpos0[address[second]]
            rows[one] = (offset, terms)
        if with_tendons and model.eq_type[k] == mujoco.mjtEq.mjEQ_TENDON and second < 0:
            begin = model.tendon_adr[first]
            parts = range(begin, begin + model.tendon_num[first])
            joints = [(address[model.wrap_objid[part]], model.wrap_prm[part]) for part in parts]
            one, factor = joints[0]
            rows[one] = (data[0] / factor, [(other, -weight / factor) for other, weight in joints[1:]])
    return rows


class Robot:
    """A model of MuJoCo in the coordinates of gelenk."""

    def __init__(self, mujoco, told):
        self.mujoco, self.told = mujoco, told
        self.model = mujoco.MjModel.from_xml_path(told["file"])
        self.data = mujoco.MjData(self.model)
        self.rows = followers(mujoco, self.model, told["by_name"]) if told["couples"] else {}
        self.count = told["velocities"]
        joints = [self.model.joint(k) for k in range(self.model.njnt) if self.model.jnt_qposadr[k] not in self.rows]
        if told["by_name"]:
            joints = [self.model.joint(joint["name"]) for joint in told["joints"]]
        self.places = list(zip(joints, told["joints"], strict=True))

    def positions(self, y):
        q = self.model.qpos0.copy()
        known = set()
        for place, joint in self.places:
            at, y0 = place.qposadr[0], joint["position"]
            if joint["kind"] == "scalar":
                q[at] = y[y0]
                known.add(at)
            else:
                lead = 3 if joint["kind"] == "floating" else 0
                q[at : at + lead] = y[y0 : y0 + lead]
                x = y[y0 + lead : y0 + lead + 4]
                q[at + lead : at + lead + 4] = [x[3], x[0], x[1], x[2]]
        while len(known) < len(known | set(self.rows)):
            ready = [one for one, (_, terms) in self.rows.items() if one not in known and all(o in known for o, _ in terms)]
            if not ready:
                raise ValueError("the equalities follow each other in a circle")
            for one in ready:
                offset, terms = self.rows[one]
                q[one] = offset + sum(factor * q[other] for other, factor in terms)
                known.add(one)
        return q

    def ratios(self, q, v):
        """G, and Ġ ẏ."""
        model = self.model
        g, bias = np.zeros((model.nv, self.count)), np.zeros(model.nv)
        row_of = {}
        for place, joint in self.places:
            dof, v0 = place.dofadr[0], joint["velocity"]
            if joint["kind"] == "scalar":
                g[dof, v0] = 1.0
                row_of[place.qposadr[0]] = dof
            elif joint["kind"] == "spherical":
                g[dof : dof + 3, v0 : v0 + 3] = np.eye(3)
            else:
                rotation = np.zeros(9)
                at = place.qposadr[0] + 3
                self.mujoco.mju_quat2Mat(rotation, q[at : at + 4])
                rotation = rotation.reshape(3, 3)
                g[dof : dof + 3, v0 : v0 + 3] = rotation
                g[dof + 3 : dof + 6, v0 + 3 : v0 + 6] = np.eye(3)
                bias[dof : dof + 3] = rotation @ np.cross(v[v0 + 3 : v0 + 6], v[v0 : v0 + 3])
        dof_of = {int(model.jnt_qposadr[k]): int(model.jnt_dofadr[k]) for k in range(model.njnt)}
        open_rows = dict(self.rows)
        while open_rows:
            for one, (_, terms) in list(open_rows.items()):
                if all(other not in open_rows for other, _ in terms):
                    g[dof_of[one]] = sum((factor * g[dof_of[other]] for other, factor in terms), np.zeros(self.count))
                    del open_rows[one]
        return g, bias

    def at(self, state):
        """Puts MuJoCo to a state: G, Ġ ẏ and MuJoCo's mass matrix."""
        mujoco, model, data = self.mujoco, self.model, self.data
        y, v = np.array(state["y"]), np.array(state["v"])
        q = self.positions(y)
        g, rate = self.ratios(q, v)
        data.qpos[:], data.qvel[:] = q, g @ v
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, mass, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, mass)
        return g, rate, mass

    def values(self, state):
        mujoco, model, data = self.mujoco, self.model, self.data
        g, rate, mass = self.at(state)
        found = {"mass_matrix": g.T @ mass @ g, "bias_forces": g.T @ (data.qfrc_bias + mass @ rate)}
        if "passive" in state:
            found["passive"] = g.T @ data.qfrc_passive
        if "input_matrix" in state:
            moment = np.zeros((model.nu, model.nv))
            mujoco.mju_sparse2dense(moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
            order = [model.actuator(name).id for name in self.told["inputs"]]
            found["input_matrix"] = g.T @ moment[order].T
        return found

    def acceleration_error(self, state):
        """Error of the accelerations beside their largest with and without equalities, which are soft in MuJoCo.

        Limits and dry friction, which are constraints as well, are left out.
        """
        model, data = self.model, self.data
        model.dof_frictionloss[:], model.tendon_frictionloss[:], model.jnt_limited[:] = 0, 0, 0
        g, rate, mass = self.at(state)
        force = g.T @ (data.qfrc_passive - data.qfrc_bias - mass @ rate)
        exact = g @ np.linalg.solve(g.T @ mass @ g, force) + rate
        size = max(np.abs(exact).max(), np.abs(data.qacc_smooth).max(), 1e-12)
        return np.abs(data.qacc - exact).max() / size


def mujoco_errors(mujoco, told):
    """The largest error of each array."""
    robot = Robot(mujoco, told)
    worst = {}
    for state in told["states"]:
        for name, array in robot.values(state).items():
            wanted = array.ravel()
            error = relative(np.array(state[name]), wanted)
            worst[name] = error if not error <= worst.get(name, 0.0) else worst.get(name, 0.0)
    # Files of others may have softer equalities. Those of random robots may have bodies of almost no inertia, which MuJoCo
    # holds by no equality: of 600 robots 586 are within 0.003, and 5 have errors above 0.5.
    if told["by_name"] and "passive" in told["states"][0]:
        worst["acceleration"] = np.max([robot.acceleration_error(state) for state in told["states"]])
    return worst


def pinocchio_errors(pin, told):
    """As `mujoco_errors`, for a URDF without joints that Pinocchio does not know."""
    model = pin.buildModelFromUrdf(told["file"])
    names = [joint["name"] for joint in told["joints"]]
    if list(model.names)[1:] != names:
        raise ValueError(f"joints {list(model.names)[1:]}, expected {names}")
    model.gravity.linear = np.array(told["gravity"])
    data, worst = model.createData(), {}
    for state in told["states"]:
        # What turns without end has cosine and sine in Pinocchio.
        q = pin.neutral(model)
        for joint, name in zip(told["joints"], names):
            at = model.joints[model.getJointId(name)]
            y0 = joint["position"]
            if joint["kind"] == "scalar":
                x = state["y"][y0]
                q[at.idx_q : at.idx_q + at.nq] = [x] if at.nq == 1 else [np.cos(x), np.sin(x)]
            else:
                q[at.idx_q : at.idx_q + at.nq] = state["y"][y0 : y0 + at.nq]
        v = np.array(state["v"])
        upper = np.triu(pin.crba(model, data, q).copy())
        found = {"mass_matrix": upper + np.triu(upper, 1).T, "bias_forces": pin.nonLinearEffects(model, data, q, v)}
        for name, array in found.items():
            worst[name] = max(worst.get(name, 0.0), relative(np.array(state[name]), array.ravel()))
    return worst


def listed():
    """Files in MJCF of the installed packages."""
    import importlib.util

    for package in ROBOTS:
        found = importlib.util.find_spec(package)
        for folder in (found.submodule_search_locations or []) if found else []:
            for place, _, files in sorted(os.walk(folder)):
                for file in sorted(files):
                    path = os.path.join(place, file)
                    if file.endswith(".xml") and b"<mujoco" in open(path, "rb").read():
                        print(f"{package}\t{os.path.relpath(path, folder)}\t{path}")


def main(values):
    try:
        import mujoco
    except ImportError as missing:
        print(f"skipped: {missing}; `pip install mujoco` makes the comparison possible")
        return 0
    try:
        import pinocchio as pin
    except ImportError:
        pin = None
        print("skipped for Pinocchio: `pip install pin` makes its comparison possible")
    robots, agreeing = json.load(open(values)), 0
    for told in robots:
        is_urdf = told["file"].endswith(".urdf")
        if is_urdf and pin is None:
            agreeing += 1
            continue
        try:
            worst = pinocchio_errors(pin, told) if is_urdf else mujoco_errors(mujoco, told)
        except Exception as wrong:  # What MuJoCo or Pinocchio raises is the answer.
            print(f"{told['name']:44} {type(wrong).__name__}: {str(wrong).splitlines()[0][:120]}   DIFFERS")
            continue
        agrees = all(error <= MOST_OF.get(name, MOST) for name, error in worst.items())
        agreeing += agrees
        cells = " ".join(f"{name} {error:.1e}" for name, error in worst.items())
        print(f"{told['name']:44} {cells}{'' if agrees else '   DIFFERS'}", flush=True)
    print(f"{agreeing} of {len(robots)} robots agree with MuJoCo {mujoco.__version__} to {MOST:g}")
    return 0 if agreeing == len(robots) else 1


if len(sys.argv) != 2:
    sys.exit(__doc__)
sys.exit(listed() if sys.argv[1] == "--list" else main(sys.argv[1]))
