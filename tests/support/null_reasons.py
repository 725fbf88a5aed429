"""A rule for JSON output: every null has a reason in the same object."""


def nulls_without_reason(value, path="$"):
    """The paths of all nulls without a reason in the same object."""
    if isinstance(value, list):
        return [where for k, entry in enumerate(value) for where in nulls_without_reason(entry, f"{path}[{k}]")]
    if not isinstance(value, dict):
        return []
    explained = any("reason" in key for key in value)
    here = [f"{path}.{key}" for key, entry in value.items() if entry is None and not explained]
    return here + [where for key, entry in value.items() for where in nulls_without_reason(entry, f"{path}.{key}")]
