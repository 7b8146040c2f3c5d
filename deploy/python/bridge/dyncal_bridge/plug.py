"""What all plugs have in common: a thread of their own that takes from a bounded queue.

`offer` is called by the thread that reads the bus and never waits: what a slow peer does not take
stays in the queue, where newer documents replace older ones and samples are dropped (see
`bounded_queue`). A plug that fails says so once and is tried again; the others go on.
"""

from __future__ import annotations

import abc
import logging
import threading
from collections.abc import Callable, Sequence

from dyncal_bridge.bounded_queue import BoundedQueue
from dyncal_bridge.document import ChannelSamples, Document, Item, NewRun

MAX_DOCUMENTS, MAX_SAMPLE_BLOCKS = 24_000, 500  # more documents than a view of the benches has
TAKE_TIMEOUT_S = 0.2
RETRY_S = 5.0


class Plug(abc.ABC):
    """name: for logs. max_rate_hz: of the rows of samples that it takes."""

    def __init__(self, name: str, max_rate_hz: float) -> None:
        self.name, self.max_rate_hz = name, max_rate_hz
        self.queue: BoundedQueue[Item] = BoundedQueue(MAX_DOCUMENTS, MAX_SAMPLE_BLOCKS)
        self.wants_changed: Callable[[], None] = lambda: None  # set by who reads the samples
        self.log = logging.getLogger(f"dyncal-bridge.{name}")
        self.stopping = threading.Event()
        self.runs: dict[str, str] = {}  # the newest of each bench
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def offer(self, item: Item) -> None:
        """Of the thread that reads the bus."""
        if isinstance(item, ChannelSamples):
            self.queue.put_samples(item)
            return
        if isinstance(item, NewRun):
            self.runs[item.bench] = item.run
        self.queue.put_document(item.key, item)

    def wanted(self, bench: str, source: str, channels: Sequence[str]) -> set[str]:
        """Of which channels of a source it takes samples now. Any thread."""
        return set()

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """Asks it to end; does not wait."""
        self.stopping.set()
        self.queue.close()

    def join(self, timeout_s: float) -> bool:
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    @abc.abstractmethod
    def open(self) -> None:
        """Begins to serve. Raises OSError, BridgeError: not now."""

    @abc.abstractmethod
    def close(self) -> None:
        """The opposite; also after an `open` that has failed."""

    @abc.abstractmethod
    def serve(self, item: Item) -> None:
        """Hands one item on."""

    def idle(self) -> None:
        """Called every 0.2 s when nothing is in the queue."""

    def is_ready(self) -> bool:
        """Whether the peer takes more now; else all stays in the queue."""
        return True

    def counts(self) -> dict[str, int]:
        """What was not handed on, since the start."""
        return {
            "dropped_documents": self.queue.counts.dropped_documents,
            "dropped_samples": self.queue.counts.dropped_samples,
        }

    def _run(self) -> None:
        said = ""
        while not self.stopping.is_set():
            try:
                self.open()
                said = ""
                self._serve_all()
            except Exception as problem:  # whatever a peer's library raises ends no other plug
                words = str(problem) or repr(problem)
                if said != words:
                    said = words
                    self.log.error("%s; tried again every %.0f s", words, RETRY_S)
            finally:
                self.close()
            self.stopping.wait(RETRY_S)

    def _serve_all(self) -> None:
        while not self.stopping.is_set():
            item = self.queue.take(TAKE_TIMEOUT_S) if self.is_ready() else None
            if item is not None:
                if self._counts_still(item):
                    self.serve(item)
            elif not self.is_ready():
                self.stopping.wait(TAKE_TIMEOUT_S)
            self.idle()

    def _counts_still(self, item: Item) -> bool:
        """Not a result of a run that another one has followed while it waited."""
        if not isinstance(item, Document) or not item.run:
            return True
        return self.runs.get(item.bench, item.run) == item.run


def path_of(document: Document) -> tuple[str, ...]:
    """Where a document stands in a tree of names, below its bench."""
    if document.kind == "state":
        return ("state",)
    if document.kind == "source":
        return ("sources", *document.name)
    folder = "points" if document.kind == "point" else "transfer_functions"
    source, _, channel = document.name[0].partition("/")
    return (folder, source, channel, *document.name[1:])
