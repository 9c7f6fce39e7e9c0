"""Progress in notebooks and terminals."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Optional

#: Least time between two updates in seconds.
INTERVAL_S = 0.2


@contextmanager
def elapsed(doing: str, is_shown: bool) -> Iterator[None]:
    """Show the seconds since the begin of work without steps."""
    if not is_shown:
        yield
        return
    is_done = threading.Event()
    start = time.monotonic()
    with progress_bar("seconds", True) as report:
        assert report is not None

        def tell() -> None:
            while not is_done.wait(1.0):
                report(0, 0, f"{doing}: {time.monotonic() - start:.0f} s")

        teller = threading.Thread(target=tell, daemon=True)
        teller.start()
        try:
            yield
        finally:
            is_done.set()
            teller.join()
            report(1, 1, f"{doing}: done in {time.monotonic() - start:.1f} s")


@contextmanager
def progress_bar(noun: str, is_shown: bool) -> Iterator[Optional[Callable[..., None]]]:
    """Yield a function of (done, total) that shows a bar, or None; a third argument is a text in place of the counts."""
    if not is_shown:
        yield None
        return
    start, last = time.monotonic(), [0.0]
    handle: Any = None
    html: Any = None
    is_notebook = "ipykernel" in sys.modules
    if is_notebook:
        import IPython.display as notebook

        show: Any = notebook.display
        html = notebook.HTML
        handle = show(html(""), display_id=True)

    def report(done: int, total: int, text: Optional[str] = None) -> None:
        now = time.monotonic()
        if done < total and now - last[0] < INTERVAL_S:
            return
        last[0] = now
        rate = done / max(now - start, 1e-9)
        bar = "<progress>" if total == 0 else f'<progress value="{done}" max="{total}">'
        text = text or f"{done} of {total} {noun}, {rate:.0f} per second"
        if handle is not None:
            handle.update(html(f"{bar}</progress> {text}"))
        elif sys.stderr.isatty():
            sys.stderr.write(f"\r{text}\x1b[K" + ("\n" if done == total else ""))
            sys.stderr.flush()

    yield report
