"""Serve a page to browsers on this computer until the process is interrupted."""

from __future__ import annotations

import io
import socket
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from typing import TYPE_CHECKING

from srgc.faults import UsageFault
from srgc.view.page import ViewPage
from srgc.view.shown_designs import ShownDesigns

if TYPE_CHECKING:
    import viser

HOST, PORT = "127.0.0.1", 8080
INSTALL = 'the page needs the library viser: pip install "srgc[view]"'
TICK = 1 / 30
"""The time between two frames of a playing page, in seconds."""


def refuse_without_viewer(port: int | None) -> None:
    """Reject a page that could not be served, before anything is computed.

    Raises:
        UsageFault: the library is missing, or the port is in use.
    """
    try:
        import viser  # noqa: F401
    except ModuleNotFoundError:
        raise UsageFault(INSTALL) from None
    if port is None:
        return
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, port))
        except OSError as error:
            raise UsageFault(f"port {port} cannot be used: {error.strerror}") from None


def viewer_server(port: int | None) -> viser.ViserServer:
    """A server for this computer only; if the port is None, it is the first free one from 8080 on.

    Raises:
        UsageFault: the library is missing, or the port is in use.
    """
    refuse_without_viewer(port)
    import viser

    with redirect_stdout(io.StringIO()):  # hide its greeting and its own form of the address
        return viser.ViserServer(host=HOST, port=PORT if port is None else port, verbose=False)


def page_address(server: viser.ViserServer) -> str:
    """The address of the page."""
    return f"http://{HOST}:{server.get_port()}"


def serve(shown: ShownDesigns, server: viser.ViserServer, ready: Callable[[str], object]) -> None:
    """Show designs and play them forever; ``ready`` is called with the address of the page."""
    page = ViewPage(server, shown.designs)
    ready(page_address(server))
    last = time.monotonic()
    while True:
        time.sleep(TICK)
        now = time.monotonic()
        page.tick(now - last)
        last = now
