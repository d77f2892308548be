#!/usr/bin/env python3
"""M and bias forces of gelenk compared with those of MuJoCo, for all files in MJCF below a folder.

usage: folder.py FOLDER [GELENK]      a line for each file; exit code 1 if one differs without a warning about meshes or masses

GELENK is the program, by default `gelenk`. It exports each file as MJCF; MuJoCo computes M and the bias forces of both, over all
joints, which are found by their names, along motions that linear equalities leave. Files without joints are no robots. Geoms whose mesh is absent are removed for MuJoCo, as
gelenk leaves them out. Without MuJoCo the comparison is skipped.
"""
import os
import subprocess
import sys
import tempfile

MOST = 1e-9
STATES = 4


def plain_model(mujoco, file):
    """The model without what only pictures need, and without meshes that are absent."""
    spec = mujoco.MjSpec.from_file(file)
    folder = os.path.join(os.path.dirname(file), spec.meshdir)
    absent = {mesh.name or os.path.splitext(os.path.basename(mesh.file))[0] for mesh in spec.meshes
              if mesh.file and not os.path.isfile(os.path.join(folder, mesh.file.replace("\\", "/")))}
    for geom in list(spec.geoms):
        geom.material = ""
        if geom.meshname in absent:
            spec.delete(geom)
    for kind in (spec.sensors, spec.keys, spec.pairs, spec.excludes, spec.skins):
        for each in list(kind):
            spec.delete(each)
    for site in spec.sites:
        site.material = ""
    for tendon in spec.tendons:
        tendon.material = ""
    for mesh in list(spec.meshes):
        mesh.material = ""
        if (mesh.name or os.path.splitext(os.path.basename(mesh.file))[0]) in absent:
            spec.delete(mesh)
    for kind in (spec.materials, spec.textures):
        for each in list(kind):
            spec.delete(each)
    return spec.compile()


def joints(model):
    """Joints by their names; those without a name as gelenk names them."""
    named = ((model.joint(k).name or f"{model.body(model.jnt_bodyid[k]).name}_joint", k) for k in range(model.njnt))
    return dict(named)


def matrices(mujoco, np, model, positions, velocities):
    """M and the bias forces at positions and velocities by joint; rows in the order of `positions`."""
    data, known = mujoco.MjData(model), joints(model)
    rows = []
    for name, (q, v) in zip(positions, zip(positions.values(), velocities.values())):
        joint = model.joint(known[name])
        data.qpos[joint.qposadr[0] : joint.qposadr[0] + len(q)] = q
        data.qvel[joint.dofadr[0] : joint.dofadr[0] + len(v)] = v
        rows.extend(range(joint.dofadr[0], joint.dofadr[0] + len(v)))
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, mass, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, mass)
    return mass[np.ix_(rows, rows)], data.qfrc_bias[rows]


def motions(mujoco, np, model):
    """A basis of the velocities that linear equalities of joints and tendons leave, in the order of the joints: an armature of
    a joint that follows is one of the joint that it follows, too."""
    kinds, rows = [int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON)], []
    for k in range(model.neq):
        kind, data = int(model.eq_type[k]), model.eq_data[k]
        if kind not in kinds or not model.eq_active0[k]:
            continue
        row = np.zeros(model.nv)
        for index, factor in ((model.eq_obj1id[k], 1.0), (model.eq_obj2id[k], -data[1])):
            if index >= 0 and kind == kinds[0]:
                row[model.jnt_dofadr[index]] += factor
            elif index >= 0:
                begin = model.tendon_adr[index]
                for part in range(begin, begin + model.tendon_num[index]):
                    row[model.jnt_dofadr[model.wrap_objid[part]]] += factor * model.wrap_prm[part]
        rows.append(row)
    if not rows:
        return np.eye(model.nv)
    _, sizes, basis = np.linalg.svd(np.array(rows))
    return basis[(sizes > 1e-12).sum() :].T


def difference(mujoco, np, theirs, ours):
    """The largest error of M and of the bias forces, relative to their largest entries."""
    rng = np.random.default_rng(1606)
    names = joints(theirs)
    missing = [name for name in names if name not in joints(ours)]
    if missing or theirs.nv != ours.nv:
        raise ValueError(f"{theirs.nv} and {ours.nv} velocities, joints {missing[:3]} are absent")
    basis, worst = motions(mujoco, np, theirs), [0.0, 0.0]
    for _ in range(STATES):
        positions, velocities = {}, {}
        for name, index in names.items():
            kind = int(theirs.jnt_type[index])
            q = rng.uniform(-1, 1, {0: 7, 1: 4}.get(kind, 1))
            if kind < 2:
                q[-4:] /= np.linalg.norm(q[-4:])
            positions[name], velocities[name] = q, rng.uniform(-2, 2, {0: 6, 1: 3}.get(kind, 1))
        pair = [matrices(mujoco, np, model, positions, velocities) for model in (theirs, ours)]
        pair = [(basis.T @ mass @ basis, basis.T @ bias) for mass, bias in pair]
        for k, (wanted, found) in enumerate(zip(*pair)):
            size = max(np.abs(wanted).max(), 1e-12)
            worst[k] = max(worst[k], np.abs(found - wanted).max() / size)
    return worst


def main(folder, program="gelenk"):
    try:
        import mujoco
        import numpy as np
    except ImportError as absent:
        print(f"skipped: {absent}; `pip install mujoco` makes the comparison possible")
        return 0
    files = [os.path.join(place, name) for place, _, names in sorted(os.walk(folder)) for name in sorted(names)]
    counts = {"agrees": 0, "has a warning": 0, "refused by MuJoCo": 0, "refused by gelenk": 0, "DIFFERS": 0}
    for file in files:
        if not file.endswith(".xml"):
            continue
        name = os.path.relpath(file, folder)
        try:
            theirs = plain_model(mujoco, file)
        except Exception as wrong:  # What MuJoCo raises is the answer.
            counts["refused by MuJoCo"] += 1
            print(f"{name:60} refused by MuJoCo: {str(wrong).splitlines()[0][:100]}", flush=True)
            continue
        if theirs.njnt == 0:
            continue
        with tempfile.TemporaryDirectory() as place:
            out = os.path.join(place, "robot.xml")
            done = subprocess.run([program, "export", file, "--mjcf", "--accept-unphysical", "--output", out],
                                  capture_output=True, encoding="utf-8")
            if done.returncode != 0:
                first = next((line for line in done.stderr.splitlines() if line.startswith("error")), "")
                counts["refused by gelenk"] += 1
                print(f"{name:60} {first[:120]}", flush=True)
                continue
            try:
                mass, bias = difference(mujoco, np, theirs, mujoco.MjModel.from_xml_path(out))
            except Exception as wrong:
                mass = bias = np.inf
                print(f"{name:60} {str(wrong).splitlines()[0][:120]}")
        agrees = max(mass, bias) <= MOST
        warns = any(code in done.stderr for code in ("[mesh-inertia]", "[equality-skipped]"))
        outcome = "agrees" if agrees else "has a warning" if warns else "DIFFERS"
        counts[outcome] += 1
        print(f"{name:60} mass_matrix {mass:.1e} bias_forces {bias:.1e}   {outcome}", flush=True)
    print(f"MuJoCo {mujoco.__version__}, to {MOST:g}: " + ", ".join(f"{count} {what}" for what, count in counts.items()))
    return 1 if counts["DIFFERS"] + counts["refused by gelenk"] else 0


if len(sys.argv) not in (2, 3):
    sys.exit(__doc__)
sys.exit(main(*sys.argv[1:]))
