"""The addresses that the page answers to, and the headers that keep it to them.

A request must name in Host the very address at which it arrived, or a name that was stated at the start. An attacker's
site that resolves to this machine (DNS rebinding) has a name of its own, and is refused; so is a websocket whose Origin
is another page.
"""

import ipaddress
import re
import socket
from dataclasses import dataclass
from urllib.parse import urlsplit

from websockets.http11 import Request, Response

LOOPBACK_NAMES = ("127.0.0.1", "localhost")
DEFAULT_PORTS = {"http": 80, "https": 443}
NAME = re.compile(r"[a-z0-9]([a-z0-9.-]{0,251}[a-z0-9])?")
NOT_ON_ANY_LINK = "192.0.2.1"
"""An address for documentation (RFC 5737). A datagram socket connected to it sends nothing, and has our own address."""


@dataclass(frozen=True)
class Addresses:
    """What the page is called by those who may use it."""

    host: str = "127.0.0.1"
    """The address of this machine at which the page answers; 0.0.0.0 for all of them."""
    url: str = ""
    """The address that visitors type where a proxy stands in between: https://class.example.org."""

    def __post_init__(self) -> None:
        if not (self._is_address or NAME.fullmatch(self.host)):
            raise ValueError(f"--host {self.host}: neither an address of this machine nor a name")
        parts = urlsplit(self.url)
        if self.url and (
            parts.scheme not in DEFAULT_PORTS
            or not NAME.fullmatch(parts.hostname or "")
            or f"{parts.scheme}://{parts.netloc}" != self.url.rstrip("/").lower()
        ):
            raise ValueError(f"--url {self.url}: must be a scheme and a name, as https://class.example.org")

    @property
    def only_this_machine(self) -> bool:
        """Whether nobody but the people at this machine can reach the page, not even through a proxy."""
        return not self.url and (self.host == "localhost" or self._is_loopback)

    @property
    def bound(self) -> str:
        """What the server listens at."""
        return "127.0.0.1" if self.host == "localhost" else self.host

    @property
    def secure(self) -> bool:
        """Whether browsers reach the page by https."""
        return self.url.startswith("https:")

    def link(self, port: int) -> str:
        """The page's address as visitors type it, with a slash at its end."""
        if self.url:
            return self.url.rstrip("/") + "/"
        return f"http://{_authority(_own_address() if self._is_unspecified else self.host, port)}/"

    def own_link(self, port: int) -> str:
        """The page's address as a program on this machine reaches it, without a proxy."""
        loopback = "::1" if ":" in self.host else "127.0.0.1"
        return f"http://{_authority(loopback if self._is_unspecified else self.host, port)}/"

    def refusal(self, request: Request, arrived_at: str, port: int) -> str | None:
        """Why a request is refused, or None. `arrived_at`: the address of this machine at which it arrived."""
        hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
        if len(hosts) != 1 or hosts[0].lower() not in self._hosts(arrived_at, port):
            return "This page answers only to its own address" + " on this machine." * self.only_this_machine
        if len(origins) > 1 or not self._origins(arrived_at, port).issuperset(origins):
            return "Requests from other sites are refused."
        if request.headers.get_all("Upgrade") and not origins:
            return "A websocket must say which page it comes from."
        if (
            request.headers.get("Sec-Fetch-Site") == "cross-site"
            and request.headers.get("Sec-Fetch-Mode") != "navigate"
        ):
            return "Requests from other sites are refused."
        return None

    def add_headers(self, response: Response, arrived_at: str, port: int) -> None:
        """Add headers that forbid other sites to embed the page, and forbid the page to connect to other servers."""
        sockets = " ".join(sorted(origin.replace("http", "ws", 1) for origin in self._origins(arrived_at, port)))
        headers = response.headers
        headers["X-Frame-Options"] = "DENY"
        if "Content-Security-Policy" not in headers:
            headers["Content-Security-Policy"] = (  # viser's page unpacks itself from an inline script, and a blob
                "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; "
                f"connect-src 'self' data: blob: {sockets}; "
                "frame-ancestors 'none'; object-src 'none'; base-uri 'none'; form-action 'none'"
            )
        headers["Referrer-Policy"] = "no-referrer"
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Cross-Origin-Resource-Policy"] = "same-origin"
        if self.secure:  # browsers ignore the first, with an error, where a page is not secure
            headers["Cross-Origin-Opener-Policy"] = "same-origin"
            headers["Strict-Transport-Security"] = "max-age=86400"

    @property
    def _is_address(self) -> bool:
        try:
            ipaddress.ip_address(self.host)
        except ValueError:
            return False
        return True

    @property
    def _is_loopback(self) -> bool:
        return self._is_address and ipaddress.ip_address(self.host).is_loopback

    @property
    def _is_unspecified(self) -> bool:
        """Whether the host stands for all addresses of this machine."""
        return self._is_address and ipaddress.ip_address(self.host).is_unspecified

    def _hosts(self, arrived_at: str, port: int) -> set[str]:
        return {origin.partition("://")[2] for origin in self._origins(arrived_at, port)}

    def _origins(self, arrived_at: str, port: int) -> set[str]:
        """The page's address as an Origin, in all spellings that browsers use for it."""
        named = set() if self._is_unspecified else {self.host}
        names = {*LOOPBACK_NAMES, self.host} if self.only_this_machine else {arrived_at} | named
        origins = {f"http://{_authority(name, port)}" for name in names}
        return origins | ({self.url.rstrip("/").lower()} if self.url else set())


def _authority(name: str, port: int) -> str:
    """A name or address with its port, as browsers write them: without the port that http has anyway."""
    bracketed = f"[{name}]" if ":" in name else name
    return bracketed if port == DEFAULT_PORTS["http"] else f"{bracketed}:{port}"


def _own_address() -> str:
    """The address of this machine in its network, which others can type; its name where it is in no network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((NOT_ON_ANY_LINK, 9))
            return str(probe.getsockname()[0])
        except OSError:
            return socket.gethostname().lower()
