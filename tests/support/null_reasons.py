"""What a JSON answer owes its reader: no null without a reason beside it."""


def nulls_without_reason(value, path="$"):
    """The places of an answer where a null stands without a reason beside it."""
    if isinstance(value, list):
        return [place for k, entry in enumerate(value) for place in nulls_without_reason(entry, f"{path}[{k}]")]
    if not isinstance(value, dict):
        return []
    explained = any("reason" in key for key in value)
    here = [f"{path}.{key}" for key, entry in value.items() if entry is None and not explained]
    return here + [place for key, entry in value.items() for place in nulls_without_reason(entry, f"{path}.{key}")]
