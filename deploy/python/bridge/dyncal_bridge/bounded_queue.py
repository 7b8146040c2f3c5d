"""What waits for a peer: never more than a stated count, and whoever puts never waits.

Two lanes. *Documents* have a key: a newer one takes the place of the one that still waits, for it
says the same anew ("the newest counts"); beyond the limit the oldest is dropped. *Samples* have no
key; beyond the limit the oldest block is dropped. Documents are taken before samples. What was
replaced or dropped is counted. Any thread.
"""

from __future__ import annotations

import collections
import dataclasses
import threading
from collections.abc import Hashable
from typing import Generic, TypeVar

Item = TypeVar("Item")


@dataclasses.dataclass
class Counts:
    """Since the start of the queue."""

    taken: int = 0
    replaced_documents: int = 0
    dropped_documents: int = 0
    dropped_samples: int = 0


class BoundedQueue(Generic[Item]):
    def __init__(self, max_documents: int, max_samples: int) -> None:
        self.counts = Counts()
        self._max_documents, self._max_samples = max_documents, max_samples
        self._documents: collections.OrderedDict[Hashable, Item] = collections.OrderedDict()
        self._samples: collections.deque[Item] = collections.deque()
        self._changed = threading.Condition()
        self._is_closed = False

    def put_document(self, key: Hashable, item: Item) -> None:
        with self._changed:
            if key in self._documents:
                self.counts.replaced_documents += 1
            elif len(self._documents) >= self._max_documents:
                self._documents.popitem(last=False)
                self.counts.dropped_documents += 1
            self._documents[key] = item
            self._changed.notify()

    def put_samples(self, item: Item) -> None:
        with self._changed:
            if len(self._samples) >= self._max_samples:
                self._samples.popleft()
                self.counts.dropped_samples += 1
            self._samples.append(item)
            self._changed.notify()

    def take(self, timeout_s: float) -> Item | None:
        """The next one; None where none came in that time, or the queue is closed."""
        with self._changed:
            self._changed.wait_for(self._has_something, timeout_s)
            if self._is_closed or not (self._documents or self._samples):
                return None
            self.counts.taken += 1
            if self._documents:
                return self._documents.popitem(last=False)[1]
            return self._samples.popleft()

    def close(self) -> None:
        """Whoever waits in take() gets None at once."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def __len__(self) -> int:
        with self._changed:
            return len(self._documents) + len(self._samples)

    def _has_something(self) -> bool:
        return bool(self._is_closed or self._documents or self._samples)
