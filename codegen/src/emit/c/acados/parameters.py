def parameters(period: float, values: Mapping[str, float] | None = None) -> np.ndarray:
    """Returns the parameters p of a stage: the period in s, then the free parameters. Parameters that `values` does not contain have
    the values of the description."""
    values = values or {}
    unknown = [name for name in values if name not in PARAMETERS]
    if unknown:
        known = ", ".join(PARAMETERS) or "none"
        raise ValueError(f"{NAME} has no parameter `{unknown[0]}`; it has {known}")
    return np.array([period, *(values.get(name, described) for name, described in PARAMETERS.items())], float)
