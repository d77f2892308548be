#!/usr/bin/env python3
"""Writes a chain of the comparison (one line of 25 numbers per joint, see its make_models.py) as a URDF.

usage: chain_urdf.py MODEL.txt ROBOT.urdf
"""
import math
import sys


def link(name, mass, center, inertia):
    xx, xy, xz, yy, yz, zz = inertia
    return (
        f'  <link name="{name}"><inertial><origin xyz="{" ".join(map(repr, center))}"/><mass value="{mass!r}"/>'
        f'<inertia ixx="{xx!r}" ixy="{xy!r}" ixz="{xz!r}" iyy="{yy!r}" iyz="{yz!r}" izz="{zz!r}"/></inertial></link>\n'
    )


def main(model, urdf):
    head, *lines = open(model).read().strip().splitlines()
    text = f'<robot name="chain{head.split()[0]}">\n  <link name="base"/>\n'
    for k, line in enumerate(lines):
        x = [float(word) for word in line.split()]
        rotation, translation, axis, mass, center, inertia = x[:9], x[9:12], x[12:15], x[15], x[16:19], x[19:25]
        # The chains turn their frames about x alone.
        assert rotation[0] == 1.0
        roll = math.atan2(rotation[7], rotation[4])
        parent = f"link{k}" if k else "base"
        text += link(f"link{k + 1}", mass, center, inertia)
        text += (
            f'  <joint name="q{k + 1}" type="continuous"><parent link="{parent}"/><child link="link{k + 1}"/>'
            f'<origin xyz="{" ".join(map(repr, translation))}" rpy="{roll!r} 0 0"/><axis xyz="{" ".join(map(repr, axis))}"/></joint>\n'
        )
    open(urdf, "w").write(text + "</robot>\n")


main(*sys.argv[1:])
