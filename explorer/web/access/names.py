"""What a visitor is called before the visitor has chosen a name: an animal, by the order of coming in."""

ANIMALS = (
    "Otter", "Heron", "Lynx", "Gecko", "Puffin", "Badger", "Ibis", "Marten", "Newt", "Osprey", "Panda", "Quail",
    "Raven", "Seal", "Tapir", "Urchin", "Viper", "Walrus", "Yak", "Zebra", "Alpaca", "Beaver", "Crane", "Dingo",
    "Egret", "Falcon", "Gibbon", "Hare", "Impala", "Jackal", "Koala", "Lemur", "Moose", "Narwhal", "Ocelot", "Pelican",
    "Rook", "Stoat", "Tern", "Wombat",
)  # fmt: skip


def name_of(number: int) -> str:
    """The name of the visitor with a number from 1; after the last animal they begin again, as "Otter 2"."""
    again, index = divmod(number - 1, len(ANIMALS))
    return ANIMALS[index] + (f" {again + 1}" if again else "")
