def parameters(
    period: float, values: Mapping[str, float] | None = None, y_ref: Any = NEUTRAL, y_ref_next: Any = None
) -> np.ndarray:
    """Returns the parameters p of a stage: the period in s, the reference positions of x = (d, v) at the beginning and end of the
    period, then the free parameters. Parameters that `values` does not contain have the values of the description.

    - `y_ref`: NY reference positions, whose quaternions are normalized
    - `y_ref_next`: reference positions of the next stage, by default the same positions
    """
    values = values or {}
    unknown = [name for name in values if name not in PARAMETERS]
    if unknown:
        known = ", ".join(PARAMETERS) or "none"
        raise ValueError(f"{NAME} has no parameter `{unknown[0]}`; it has {known}")
    free = np.array([values.get(name, described) for name, described in PARAMETERS.items()], float)
    y_ref_next = y_ref if y_ref_next is None else y_ref_next
    return np.concatenate([[period], normalized(y_ref), normalized(y_ref_next), free])


def refer(solver: AcadosOcpSolver, ocp: AcadosOcp, references: Any, values: Mapping[str, float] | None = None) -> None:
    """Sets the reference positions of a solver: one row of NY entries for each stage. There is one more stage than there are periods.

    The limits of positions are shifted accordingly. Afterwards, set the state of stage 0 to `difference(references[0], y)`, then v.
    """
    references = np.asarray(references, float)
    constraints, steps = ocp.constraints, ocp.solver_options.time_steps
    if references.shape != (len(steps) + 1, NY):
        raise ValueError(f"references have the shape {references.shape}, not ({len(steps) + 1}, {NY})")
    for stage, period in enumerate(steps):
        solver.set(stage, "p", parameters(period, values, references[stage], references[stage + 1]))
    for stage, reference in enumerate(references):
        is_last = stage == len(steps)
        which, low, high = (getattr(constraints, name + "_e" * is_last) for name in ("idxbx", "lbx", "ubx"))
        matrix, lowest, highest = (getattr(constraints, name + "_e" * is_last) for name in ("C", "lg", "ug"))
        shift = np.concatenate([_coordinates(reference), np.zeros(N)])
        if stage > 0 and which.size:
            solver.constraints_set(stage, "lbx", _moved(low, shift[which]))
            solver.constraints_set(stage, "ubx", _moved(high, shift[which]))
        if lowest.size:
            solver.constraints_set(stage, "lg", _moved(lowest, matrix @ shift))
            solver.constraints_set(stage, "ug", _moved(highest, matrix @ shift))


def normalized(y: Any) -> np.ndarray:
    """Returns the positions with quaternions of unit length."""
    y = np.array(y, float)
    if y.shape != (NY,):
        raise ValueError(f"positions have the shape {y.shape}, not ({NY},)")
    for entries, first in zip(JOINT_POSITIONS, FIRST_POSITIONS):
        if entries > 1:
            quaternion = y[first + entries - 4 : first + entries]
            length = np.linalg.norm(quaternion)
            if not 0 < length < np.inf:
                raise ValueError(f"the quaternion {quaternion} has no direction")
            quaternion /= length
    return y


def difference(y_ref: Any, y: Any) -> np.ndarray:
    """Returns the displacement d with y = y_ref ⊕ d: N velocities that lead from y_ref to y in one second."""
    start, end = normalized(y_ref), normalized(y)
    d = []
    for entries, first in zip(JOINT_POSITIONS, FIRST_POSITIONS):
        own, other = start[first : first + entries], end[first : first + entries]
        if entries == 1:
            d += [*(other - own)]
            continue
        turned = _rotation(own[-4:], other[-4:])
        if entries == 7:
            d += [*_way(own[-4:], other[:3] - own[:3], turned)]
        d += [*turned]
    return np.array(d)


def _rotation(q: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Returns the shortest rotation vector from the attitude q to the attitude r, in the axes of q."""
    axis = q[3] * r[:3] - r[3] * q[:3] - np.cross(q[:3], r[:3])
    cosine, sine = q @ r, np.linalg.norm(axis)
    # A quaternion and its negative describe the same attitude.
    angle = 2 * np.arctan2(sine, abs(cosine))
    return axis * (np.sign(cosine) or 1.0) * (angle / sine if sine > 0 else 2.0)


def _way(q: np.ndarray, way: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Returns the linear velocity that, together with the rotation `turned`, causes the displacement `way` in one second."""
    v = -q[:3]
    inside = way + 2 * q[3] * np.cross(v, way) + 2 * np.cross(v, np.cross(v, way))
    half = np.linalg.norm(turned) / 2
    # (1 - x cot x) / x² tends to 1/3. For small angles, the series loses no digits.
    factor = (1 - half / np.tan(half)) / half**2 if half > 0.1 else 1 / 3 + half**2 / 45 + 2 * half**4 / 945 + half**6 / 4725
    across = np.cross(turned, inside)
    return inside - across / 2 + factor / 4 * np.cross(turned, across)


def _coordinates(y: np.ndarray) -> np.ndarray:
    """Returns, for each velocity, the position that is its integral; 0 for joints with quaternions, which have no position limits."""
    shift = np.zeros(N)
    for entries, first, velocity in zip(JOINT_POSITIONS, FIRST_POSITIONS, FIRST_VELOCITIES):
        if entries == 1:
            shift[velocity] = y[first]
    return shift


def _moved(bounds: np.ndarray, by: np.ndarray) -> np.ndarray:
    return np.where(np.abs(bounds) < UNLIMITED, bounds - by, bounds)
