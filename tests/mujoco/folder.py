#!/usr/bin/env python3
"""M and bias forces of gelenk beside those of MuJoCo, for all files in MJCF below a folder.

usage: folder.py FOLDER [GELENK]      prints a line for each file; exit code 1 where one differs without a warning

GELENK is the program, by default `gelenk`. It exports each file as MJCF, and MuJoCo computes both: joints are found by their
names, joints that follow others are driven by their equalities, and free joints are compared about the same frame. Files that
MuJoCo refuses are skipped, and so are all without MuJoCo. Meshes that are absent become small spheres without mass.
"""
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

MOST = 1e-9


def relative(found, wanted):
    size = max(abs(wanted).max(initial=0.0), 1e-12)
    return abs(found - wanted).max(initial=0.0) / size
