"""Sentences of a certificate as the page shows them; the certificate keeps its own, whose bytes are compared."""

from rangenav.number_format import shortened

NO_IMU_NOISE = ", no IMU noise"
PERFECT_IMU = " and a perfect IMU"


def certificate_sentence(sentence: str) -> str:
    """A sentence with four digits, since three would move a bound, and with what is assumed of the IMU."""
    return shortened(sentence, 4).replace(NO_IMU_NOISE, PERFECT_IMU)
