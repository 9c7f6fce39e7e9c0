"""Progress in notebooks and terminals."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Optional

#: Least time between two updates in seconds.
INTERVAL_S = 0.2


@contextmanager
def progress_bar(noun: str, is_shown: bool) -> Iterator[Optional[Callable[[int, int], None]]]:
    """Yield a function of (done, total) that shows a bar, or None."""
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

    def report(done: int, total: int) -> None:
        now = time.monotonic()
        if done < total and now - last[0] < INTERVAL_S:
            return
        last[0] = now
        rate = done / max(now - start, 1e-9)
        text = f"{done} of {total} {noun}, {rate:.0f} per second"
        if handle is not None:
            handle.update(html(f'<progress value="{done}" max="{total}"></progress> {text}'))
        elif sys.stderr.isatty():
            sys.stderr.write(f"\r{text}\x1b[K" + ("\n" if done == total else ""))
            sys.stderr.flush()

    yield report
